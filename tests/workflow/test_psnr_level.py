import pandas as pd


def test_the_target_compares_in_every_setting_and_builds_no_scene_of_the_run_again(project):
    planned = project.planned("psnr_level")
    assert {name for name in planned if "scenes/" in name and not name.endswith(".json")} == {
        "effects/scenes/A/antialiasing",
        "effects/scenes/C/antialiasing",
        *(
            f"psnr_level/scenes/{scene}/{way}"
            for scene in "AC"
            for way in ("pixels-12", "turned-180")
        ),
    }
    run = project.snakemake("psnr_level")
    assert run.returncode == 0, run.stdout + run.stderr
    results = project.folder / "results/tiny"
    levels = pd.read_csv(results / "tables/psnr_level.csv")
    settings = ["as-configured", "to-80-degrees", "antialiased", "covered-half", "touched"]
    assert levels["setting"].unique().tolist() == [*settings, "pixels-12", "turned-180"]
    assert levels["scene"].unique().tolist() == ["all", "A", "C"]
    assert levels["variant"].unique().tolist() == ["naive"]
    own = pd.read_csv(results / "tables/psnr.csv").query("variant == 'naive'")
    mine = levels.query("setting == 'as-configured'").set_index("scene")["psnr_db"]
    for scene, expected in zip(own["scene"], own["psnr_db"], strict=True):
        assert abs(mine[scene] - expected) < 1e-3
    assert (results / "figures/psnr_level.pdf").stat().st_size > 0
