"""The page that puts the paper's claims beside a run's findings, as Markdown."""

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from npfm.evaluation.psnr_level import ALL
from npfm.papers import (
    bagher2016,
    claims,
    claims_2004,
    claims_anisotropic,
    dupuy2015,
    lawrence2004,
    peng2017,
)
from npfm.papers.claims import Claim, Topic
from npfm.papers.evidence import Evidence, Untestable
from npfm.storage.files import Kind, marked, replacing

TITLE = "# Does it reproduce? The run"
PAGE = Kind("a page of claims", ".md", marked(TITLE.encode()))
#: What is said of isotropic materials.
TOPICS = (*claims.TOPICS, *claims_2004.TOPICS)
HOLDS, DIFFERS, UNTESTABLE = "holds", "differs", "cannot be tested here"
#: What the paper's measured tables are replaced with, by the kind of the dataset.
TABLES = {
    "neural": (
        "**The tables are not the measured ones.** The MERL database itself cannot be had here; "
        "small neural networks that were trained on it (Sztrajman et al. 2021) stand in for it. "
        "They give the measured values back to a median of 2 to 3 %, without their noise."
    ),
    "merl": "The tables are those of the files that the run names, taken for MERL's own.",
    "synthetic": (
        "**The materials are made by formulas.** What the paper found on measured ones need not "
        "hold on them."
    ),
    "formula": (
        "**The materials are formulas**, without noise. What the paper found on measured ones need "
        "not hold on them."
    ),
    "utia": "The tables are those of the files that the run names, taken for the UTIA database's.",
    "rgl": (
        "**The materials are not the paper's.** The tables are made of the files that the run "
        "names, taken for measurements of the RGL database (Dupuy and Jakob 2018)."
    ),
    "rgl-anisotropic": (
        "**The materials are not the papers'.** The tables are made of the files that the run "
        "names, taken for measurements of the RGL database (Dupuy and Jakob 2018)."
    ),
    "synthetic-anisotropic": (
        "**The materials are made by formulas.** The UTIA database (Filip and Vavra 2014), of "
        "which the papers speak, cannot be had here; a run of its files puts their claims to it."
    ),
}
#: The target whose table stands beside levels.
LEVELS_FROM = "snakemake psnr_level"
#: The kinds whose materials are anisotropic: claims about isotropic ones are not of them.
ANISOTROPIC = ("utia", "rgl-anisotropic", "synthetic-anisotropic")


def write(
    path: str | Path,
    name: str,
    dataset: str,
    evidence: Evidence,
    figures: Sequence[str],
    distance: pd.DataFrame | None,
    levels: pd.DataFrame | None = None,
) -> None:
    """Write the page.

    Parameters
    ----------
    path : str or Path
        Markdown file; links to figures start from its folder.
    name, dataset : str
        Of the run, and the kind of its dataset.
    evidence : Evidence
        Tables of the run.
    figures : sequence of str
        Paths of the figures that there are, from the page's folder.
    distance : DataFrame, optional
        As `npfm.papers.authors_distance.distance` makes it, several materials together.
    levels : DataFrame, optional
        As `npfm.evaluation.psnr_level.levels` makes it.
    """
    topics = claims_anisotropic.TOPICS if dataset in ANISOTROPIC else TOPICS
    found = [
        (topic, [(claim, *judged(claim, evidence)) for claim in topic.claims]) for topic in topics
    ]
    counts = {
        kind: Counter(row[2] for topic, rows in found if topic.levels == kind for row in rows)
        for kind in (True, False)
    }
    blocks = [
        f"{TITLE} `{name}`",
        f"{_whose(dataset)}, one by one, beside what this run says. Written by "
        "`snakemake reproduction` from the run's tables; not to be edited.",
        _tally(evidence, counts, dataset),
        TABLES[dataset],
        *([_distance(distance)] if distance is not None and not distance.empty else []),
        *(_topic(k, *found_of, figures, levels) for k, found_of in enumerate(found, start=1)),
    ]
    with replacing(path, PAGE) as temporary:
        temporary.write_text("\n\n".join(blocks) + "\n")


def judged(claim: Claim, evidence: Evidence) -> tuple[str, str, str]:
    """Put a claim to the evidence.

    Returns
    -------
    ours, verdict, difference : str
        The run's figures; `HOLDS`, `DIFFERS` or `UNTESTABLE`; by how much, or why not.
    """
    try:
        finding = claim.measure(evidence)
    except Untestable as why:
        return "", UNTESTABLE, str(why)
    if finding.holds:
        return finding.ours, HOLDS, ""
    return finding.ours, DIFFERS, finding.difference


def _whose(dataset: str) -> str:
    """Whose claims are on the page, and which of them."""
    if dataset in ANISOTROPIC:
        return f"What {peng2017.SOURCE} and {dupuy2015.SOURCE} claim of anisotropic materials"
    return (
        f"The claims of {bagher2016.SOURCE}, and at the end those of {peng2017.SOURCE}, of "
        f"{dupuy2015.SOURCE} and of {lawrence2004.SOURCE}"
    )


def _tally(evidence: Evidence, by_kind: Mapping[bool, Counter], dataset: str) -> str:
    counts = by_kind[True] + by_kind[False]
    materials = evidence.psnr["material"].nunique()
    scenes = evidence.psnr["scene"].nunique()
    papers = "" if dataset in ANISOTROPIC else "; the paper has 100 and 4"
    return (
        f"Of {counts.total()} claims {counts[HOLDS]} hold, {counts[DIFFERS]} differ and "
        f"{counts[UNTESTABLE]} cannot be tested here. The run has {materials} materials and "
        f"{scenes} scenes{papers}. Where the paper gives no measure, the one used "
        "is in brackets; an average and a gap hold within 2 dB, what the paper calls a tie, and a "
        "share within 5 points." + _kinds(by_kind)
    )


def _kinds(counts: Mapping[bool, Counter]) -> str:
    """How many claims of each kind hold, where there are both."""
    levels, others = (counts[kind] for kind in (True, False))
    if not levels:
        return ""
    return (
        " Two kinds are to be told apart. **Absolute levels** hang on scene, light and foreground: "
        f"of {levels.total()} such claims {levels[HOLDS]} hold. **What models show against each "
        f"other** (order, gaps, wins, gains), and what fits are by themselves: of "
        f"{others.total()} claims {others[HOLDS]} hold."
    )


def _distance(distance: pd.DataFrame) -> str:
    ratio = distance["published"] / distance["ours"]
    mean = distance.groupby("material", sort=True).mean(numeric_only=True)
    rows = [
        f"| {material} | {row.published:.4f} | {row.g_at_centres:.4f} | {row.f_at_degrees:.4f} | "
        f"{row.ours:.4f} | {_percent(row.log_ratio, '+')} | {_percent(row.log_error)} |"
        for material, row in mean.iterrows()
    ]
    return "\n".join(
        [
            f"The authors published their factors of {len(mean)} of the run's materials. On the "
            f"run's tables these have an objective (equation 7) {ratio.median():.2f} times that of "
            f"our own independent-g fits in the median over the channels ({ratio.min():.2f} to "
            f"{ratio.max():.2f}), and are {_percent(distance['log_error'].median())} away from the "
            "tables. Their file does not give the angles of its components: D and F are taken to "
            "be of the tables' bins, and G to be of whole degrees. "
            + _other_reading(distance, "g_at_centres", "With G at the centres of bins as well")
            + " "
            + _other_reading(distance, "f_at_degrees", "With F at whole degrees too")
            + " Means of the channels:",
            "",
            "| material | objective of the published factors | G at centres | F at whole degrees "
            "| of ours | median of published / table | median distance |",
            "|---|---|---|---|---|---|---|",
            *rows,
            "",
            "Objectives are shares of that of the zero model; medians are weighted as the fits "
            "are, and without the cells that rest on components which no sample has touched.",
        ]
    )


def _other_reading(distance: pd.DataFrame, column: str, what: str) -> str:
    """Compare a reading of the published factors with the one that is taken."""
    ratio = distance[column] / distance["published"]
    return (
        f"{what} the objective is {ratio.median():.2f} times as great in the median, and greater "
        f"in {(ratio > 1).sum()} of {len(ratio)} channels."
    )


def _levels(levels: pd.DataFrame) -> list[str]:
    """The table of `npfm.evaluation.psnr_level.levels`, variants across, all scenes together."""
    together = levels[levels["scene"] == ALL]
    variants = list(together["variant"].unique())
    table = together.pivot(index="setting", columns="variant", values="psnr_db")
    printed = together.groupby("variant")["paper_db"].first()
    rows = [("in the paper", printed), *table.reindex(together["setting"].unique()).iterrows()]
    return [
        f"The same fits by other foregrounds, pixels and lights (`{LEVELS_FROM}`); mean PSNR in dB "
        f"of at most {together['pictures'].max():.0f} pictures a number:",
        "",
        f"| setting | {' | '.join(variants)} |",
        "|---|" + "---|" * len(variants),
        *(
            f"| {name} | " + " | ".join(_decibels(row[variant]) for variant in variants) + " |"
            for name, row in rows
        ),
    ]


def _decibels(value: float) -> str:
    return f"{value:.2f}" if np.isfinite(value) else "-"


def _percent(log_ratio: float, sign: str = "") -> str:
    return f"{100 * np.expm1(log_ratio):{sign}.1f} %"


def _topic(
    number: int,
    topic: Topic,
    rows: Sequence[tuple],
    figures: Sequence[str],
    levels: pd.DataFrame | None,
) -> str:
    lines = [f"## {number}. {topic.title}", ""]
    beside = [path for name in topic.figures for path in figures if Path(path).stem == name]
    for path in beside:
        lines += [f"![{Path(path).stem}]({path})", ""]
    lines += ["| claim | paper | this run | verdict |", "|---|---|---|---|"]
    for claim, ours, verdict, difference in rows:
        told = f": {difference}" if difference else ""
        lines.append(f"| {claim.text} | {claim.paper} | {ours or '-'} | **{verdict}**{told} |")
    reasons = dict.fromkeys(claim.reason for claim, _, verdict, _ in rows if verdict == DIFFERS)
    lines += [line for reason in reasons for line in ("", f"Why: {reason}.")]
    if topic.levels and levels is not None:
        lines += ["", *_levels(levels)]
    return "\n".join(lines)
