"""What the papers claim, as data, and how each claim is put to a run's tables."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from npfm.papers import bagher2016, dupuy2015, peng2017
from npfm.papers import measures as m
from npfm.papers import measures_2015 as m15
from npfm.papers import measures_2017 as m17
from npfm.papers.evidence import NAMES, Evidence
from npfm.papers.measures import Finding


@dataclass(frozen=True)
class Claim:
    """A claim of the paper.

    Parameters
    ----------
    text : str
        What it says.
    paper : str
        Its number, with the unit.
    measure : callable
        Puts the claim to the evidence; raises `Untestable` where that has nothing to say.
    reason : str
        Why ours is likely to differ where it does.
    """

    text: str
    paper: str
    measure: Callable[[Evidence], Finding]
    reason: str


@dataclass(frozen=True)
class Topic:
    """Claims that belong together.

    Parameters
    ----------
    title : str
    figures : tuple of str
        Those of a run beside them, by their files' names.
    claims : tuple of Claim
    levels : bool
        Whether they are about absolute levels, which hang on scene and foreground, and not about
        what models show against each other.
    """

    title: str
    figures: tuple[str, ...]
    claims: tuple[Claim, ...]
    levels: bool = False


LEVEL = (
    "a level hangs on the scene, its light and on which pixels count as foreground, of which the "
    "paper prints little; what each of them moves is measured by the target psnr_level"
)
ORDER = (
    "Bilgili's method is made again here, and is first by every reading of the foreground; Ngan's "
    "numbers are scaled to the tables, and without that are below Bagher's as in the paper; Loew's "
    "model in our metric is our own search. Models that are close change places with the lights"
)
GAP = (
    "not known in full: gaps hang on lights and foreground as levels do, if less (psnr_level); and "
    "fits of the opponents are as published, or of their methods made again"
)
EXTREME = "an extreme rests on a single rendering, and moves with its light; no more is known"
LIGHTS = (
    "a lower objective is not always a higher PSNR: a rendering weighs directions by its lights, "
    "the objective by the paper's fixed weights"
)
OPPONENT = (
    "not known; how many renderings are won hangs on the lights and on what counts as foreground, "
    "as gaps do"
)
OWN_SEARCH = (
    "the fit in the paper's metric is our own search, and the other is as published: two searches "
    "are compared beside two metrics"
)
BILGILI = (
    "the paper has its authors' own fits; ours is the method made again. What was tested of that, "
    "and what is not known, is in docs/models-compared.md"
)
STARTS = "the solver is Gauss-Newton here, which stops in other places than the paper's alternation"
EXAMPLES = "the paper shows examples, and does not say that no other material is fitted worse"
UNKNOWN = "not known"
BACKSCATTER = (
    "one slice of the table decides on the microfacets; and F is found by least squares, not by "
    "the mean of ratios"
)
LAYOUT = "arrays are stored in another layout"

#: What others are put beside.
OURS = "independent-g"
BEATEN = ("Loew", "Loew, our metric", "Bagher 2012", "Ngan")
#: Materials that the paper shows its fits fail on (section 5, Figures 10 and 11).
FAILURES = ("alum-bronze", "violet-acrylic")
#: Diffuse ones for which it says that the bivariate model lacks fidelity.
DIFFUSE = ("green-latex", "red-fabric", "polyurethane-foam", "pink-felt")


def _printed(model: str) -> float:
    """The paper's average PSNR of a model, in dB."""
    return bagher2016.MEAN_PSNR_DB[NAMES[model][0]]


TOPICS = (
    Topic(
        "Average PSNR: models against each other",
        ("figure08_by_error",),
        (
            Claim(
                "order of the averages",
                " > ".join(NAMES),
                m.order,
                ORDER,
            ),
            *(
                Claim(
                    f"{model} beside independent-g, on average",
                    f"{_printed(model) - _printed(OURS):+.2f} dB",
                    partial(m.gap, model=model, other=OURS),
                    BILGILI if model == "Bilgili" else GAP,
                )
                for model in NAMES
                if model != OURS
            ),
        ),
    ),
    Topic(
        "Average PSNR: absolute levels",
        ("psnr_level",),
        tuple(
            Claim(
                f"average of {model}",
                f"{_printed(model):.2f} dB",
                partial(m.average, model=model),
                LEVEL,
            )
            for model in NAMES
        ),
        levels=True,
    ),
    Topic(
        "Gain of independent-g, and diffuseness",
        ("figure08_by_diffuseness", "figure09"),
        (
            Claim(
                "as diffuseness increases, independent-g gains on g-from-d and naive",
                "increases",
                m.gain_correlation,
                UNKNOWN,
            ),
            Claim(
                "for highly specular materials the three are similar",
                "similar (here: 2 dB)",
                m.similar_when_specular,
                UNKNOWN,
            ),
            Claim(
                "the gain over the two is up to 14 dB",
                "14 dB",
                partial(m.largest_gain, paper=14.0),
                EXTREME,
            ),
            Claim(
                "independent-g is consistently better than both",
                "all materials",
                partial(m.best_for_every_material, others=("naive", "g-from-d")),
                LIGHTS,
            ),
        ),
    ),
    Topic(
        "Compressive weighting",
        ("figure07", "figure15"),
        (
            *(
                claim
                for model in ("independent-g", "g-from-d", "naive")
                for claim in (
                    Claim(
                        f"{model}: necessary for specular materials",
                        "very poor without (here: more than 2 dB)",
                        partial(m.weighting_needed, model=model),
                        UNKNOWN,
                    ),
                    Claim(
                        f"{model}: harmless for diffuse materials",
                        "similar (here: not worse by 2 dB)",
                        partial(m.weighting_harmless, model=model),
                        UNKNOWN,
                    ),
                )
            ),
            Claim(
                "critical even for angles up to 80 degrees only",
                "better (here: more than 2 dB)",
                m.weighting_restricted,
                UNKNOWN,
            ),
        ),
    ),
    Topic(
        "Against parametric models",
        ("figure12", "figure14"),
        (
            Claim(
                "independent-g beats parametric models for all materials",
                "all materials",
                partial(m.best_for_every_material, others=BEATEN),
                OPPONENT,
            ),
            Claim(
                "renderings won against Loew, by more than 2 dB",
                "77 % (308 of 400)",
                partial(m.wins, model="Loew", paper=77.0),
                OPPONENT,
            ),
            Claim(
                "renderings tied with Loew",
                "21 % (85 of 400)",
                partial(m.ties, model="Loew", paper=21.25),
                OPPONENT,
            ),
            Claim(
                "Loew's metric serves Loew's model slightly better than the paper's",
                "+0.70 dB",
                partial(m.comparable, first="Loew", second="Loew, our metric"),
                OWN_SEARCH,
            ),
        ),
    ),
    Topic(
        "Against Bilgili's factorisation",
        ("figure13",),
        (
            Claim(
                "renderings won against Bilgili, by more than 2 dB",
                "61.5 % (236 of 400, which are 59 %)",
                partial(m.wins, model="Bilgili", paper=61.5),
                BILGILI,
            ),
            Claim(
                "renderings tied with Bilgili",
                "17.8 % (71 of 400)",
                partial(m.ties, model="Bilgili", paper=17.75),
                BILGILI,
            ),
            Claim(
                "materials with a better average than Bilgili's",
                "71 % (71 of 100)",
                partial(m.better_materials, model="Bilgili", paper=71.0),
                BILGILI,
            ),
        ),
    ),
    Topic(
        "Independence from random starts",
        (),
        (
            Claim(
                "for most materials the result does not depend on the start",
                "most (here: objectives within 5 %)",
                m.starts_agree,
                STARTS,
            ),
        ),
    ),
    Topic(
        "Which materials fail, and whether the bivariate model saves them",
        ("figure10", "figure11"),
        (
            *(
                Claim(
                    f"{name} is among the fits with the greatest visual error",
                    "shown in Figure 10",
                    partial(m.among_the_worst, material=name),
                    EXAMPLES,
                )
                for name in FAILURES
            ),
            *(
                Claim(
                    f"the bivariate model remedies {name}",
                    "better (here: more than 2 dB)",
                    partial(m.bivariate_gain, material=name, saves=True),
                    UNKNOWN,
                )
                for name in FAILURES
            ),
            *(
                Claim(
                    f"the bivariate model lacks fidelity for {name}, a diffuse one",
                    "worse than independent-g",
                    partial(m.bivariate_gain, material=name, saves=False),
                    UNKNOWN,
                )
                for name in DIFFUSE
            ),
        ),
    ),
    Topic(
        "Size",
        (),
        tuple(
            Claim(
                f"a fit of {variant}",
                f"{count} bytes",
                partial(m.size, variant=variant, paper=count),
                LAYOUT,
            )
            for variant, count in bagher2016.BYTES.items()
        ),
    ),
    Topic(
        f"Shared lobes ({peng2017.SOURCE})",
        ("figure08_by_error",),
        (
            Claim(
                "better than independent-g, in its two scenes",
                f"{peng2017.BETTER_THAN_INDEPENDENT_G} of {peng2017.MATERIALS} materials",
                m17.better_materials,
                LIGHTS,
            ),
            Claim(
                "at least as good as independent-g for every other material",
                "as good (here: not worse by 2 dB)",
                m17.never_worse,
                LIGHTS,
            ),
            Claim(
                "closer to the bivariate model than to independent-g",
                "closer",
                m17.nearer_to_bivariate,
                UNKNOWN,
            ),
            Claim(
                "for some materials even better than the bivariate model",
                "some",
                m17.sometimes_above_bivariate,
                UNKNOWN,
            ),
            Claim(
                f"{peng2017.MUCH_BETTER} is much better than by independent-g",
                "much better (here: more than 2 dB)",
                partial(m17.gain, material=peng2017.MUCH_BETTER, large=True),
                UNKNOWN,
            ),
            *(
                Claim(
                    f"{name} is not much better than by independent-g",
                    "no much improvement (here: not by 2 dB)",
                    partial(m17.gain, material=name, large=False),
                    UNKNOWN,
                )
                for name in peng2017.HARDLY_BETTER
            ),
            Claim(
                "values of a fit, and more than of independent-g",
                f"{peng2017.PARAMETERS}, {peng2017.MORE_THAN_INDEPENDENT_G:+d}",
                m17.size,
                LAYOUT,
            ),
        ),
    ),
    Topic(
        f"Power iterations ({dupuy2015.SOURCE})",
        ("power_iterations_delta_e", "power_iterations_side_by_side"),
        (
            Claim(
                "a fit takes less than a second",
                f"{dupuy2015.SECONDS:g} s, on another machine",
                partial(m15.fast, most=dupuy2015.SECONDS),
                "the time is that of the whole fit, its record included, on a busy machine",
            ),
            Claim("fits cannot fail", "guaranteed", m15.never_fails, BACKSCATTER),
            Claim(
                "on par with Loew's model for metals",
                "on par (here: not worse by 2 dB)",
                partial(m15.on_par, materials=dupuy2015.METALS, model="Loew"),
                BACKSCATTER,
            ),
            Claim(
                "superior to Bagher's 2012 model for metals",
                "superior (here: not worse by 2 dB)",
                partial(m15.on_par, materials=dupuy2015.METALS, model="Bagher 2012"),
                BACKSCATTER,
            ),
            Claim(
                "conversion to GGX is better than to Beckmann",
                "generally better",
                partial(m15.better, first="GGX", second="Beckmann"),
                BACKSCATTER,
            ),
            Claim(
                f"{dupuy2015.WORSE} is fitted worse than by the two others",
                "worse than by both",
                partial(m15.worse_for, material=dupuy2015.WORSE, others=("Loew", "Bagher 2012")),
                BACKSCATTER,
            ),
            *(
                Claim(
                    f"Bagher's 2012 fit of {name} failed",
                    "flawed (here: more than 2 dB worse)",
                    partial(m15.fails_for, material=name, model="Bagher 2012"),
                    OPPONENT,
                )
                for name in dupuy2015.SHIFTED_GAMMA_FAILS
            ),
        ),
    ),
)
