import math

import pandas as pd

from npfm.evaluation.head_to_head import head_to_head, renderings


def table(ours, other):
    rows = [
        (scene, "chalk", variant, value)
        for variant, values in (("ours", ours), ("other", other))
        for scene, value in values.items()
    ]
    return pd.DataFrame(rows, columns=["scene", "material", "variant", "psnr_db"])


def test_wins_ties_and_losses_are_counted_picture_by_picture():
    ours = {"A": 50.0, "B": 42.0, "C": 42.0, "D": 38.0, "E": 37.9}
    other = {"A": 40.0, "B": 40.0, "C": 39.9, "D": 40.0, "E": 40.0}
    score = head_to_head(table(ours, other), "ours", "other")
    assert (score.wins, score.ties, score.losses, score.missing) == (2, 2, 1, 0)
    assert score.compared == 5
    turned = head_to_head(table(ours, other), "other", "ours")
    assert (turned.wins, turned.ties, turned.losses) == (1, 2, 2)


def test_equal_pictures_tie_with_each_other_and_win_over_any_other():
    inf = math.inf
    score = head_to_head(
        table({"A": inf, "B": inf, "C": 60.0}, {"A": inf, "B": 60.0, "C": inf}), "ours", "other"
    )
    assert (score.wins, score.ties, score.losses) == (1, 1, 1)


def test_a_picture_that_one_lacks_is_missing_and_not_counted():
    score = head_to_head(table({"A": 50.0, "B": 50.0}, {"A": 40.0}), "ours", "other")
    assert (score.wins, score.compared, score.missing) == (1, 1, 1)
    nobody = head_to_head(table({"A": 50.0}, {}), "ours", "other")
    assert (nobody.compared, nobody.missing) == (0, 1)


def test_every_picture_has_a_row_in_the_order_of_the_table():
    wide = renderings(table({"B": 1.0, "A": 2.0}, {"C": 3.0}), ["other", "ours"])
    assert list(wide.index) == [("chalk", "B"), ("chalk", "A"), ("chalk", "C")]
    assert list(wide.columns) == ["other", "ours"]
    assert wide["ours"].tolist()[:2] == [1.0, 2.0]
    assert wide.isna().sum().tolist() == [2, 1]
