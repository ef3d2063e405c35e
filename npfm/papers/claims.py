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
    """Claims that belong together, and the figures of a run beside them, by their files' names."""

    title: str
    figures: tuple[str, ...]
    claims: tuple[Claim, ...]


LEVEL = (
    "the level of a PSNR hangs on the brightest pixel of a rendering, and with it on lights, "
    "shapes, camera and resolution, which the paper does not give; and published fits were made "
    "for the measured tables. Differences between models say more than levels"
)
ORDER = (
    "models whose averages are close in the paper change places with the choice of materials; and "
    "not all of the opponents' fits are those that the paper compares with"
)
SOLVER = (
    "the tables used here are smoother than measured ones, and Gauss-Newton may reach lower minima "
    "than the paper's alternation; an extreme rests on a single rendering or material"
)
LIGHTS = (
    "a lower objective is not always a higher PSNR: a rendering weighs directions by its lights, "
    "the objective by the paper's fixed weights"
)
OPPONENT = (
    "the opponent's fit was made for the measured tables, or by us; against the tables used here "
    "both stand elsewhere than in the paper"
)
BILGILI = (
    "the paper has its authors' own fits to the measured tables; ours is the method made again, "
    "and what was chosen where the original is not known may serve it better"
)
STARTS = "the solver is Gauss-Newton here, which stops in other places than the paper's alternation"
TABLES = (
    "the tables used here are not the measured ones, and differ from them in the highlights most"
)
BACKSCATTER = (
    "one slice of the table decides on the microfacets, and networks that stand in for measured "
    "tables are least sure there; F is found by least squares, not by the mean of ratios"
)
LAYOUT = "arrays are stored in another layout"

BEATEN = ("Loew", "Loew, our metric", "Bagher 2012", "Ngan")
#: Materials that the paper shows its fits fail on (section 5, Figures 10 and 11).
FAILURES = ("alum-bronze", "violet-acrylic")
#: Diffuse ones for which it says that the bivariate model lacks fidelity.
DIFFUSE = ("green-latex", "red-fabric", "polyurethane-foam", "pink-felt")

TOPICS = (
    Topic(
        "Average PSNR",
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
                    f"average of {model}",
                    f"{bagher2016.MEAN_PSNR_DB[names[0]]:.2f} dB",
                    partial(m.average, model=model),
                    LEVEL,
                )
                for model, names in NAMES.items()
            ),
        ),
    ),
    Topic(
        "Gain of independent-g, and diffuseness",
        ("figure08_by_diffuseness", "figure09"),
        (
            Claim(
                "as diffuseness increases, independent-g gains on g-from-d and naive",
                "increases",
                m.gain_correlation,
                SOLVER,
            ),
            Claim(
                "for highly specular materials the three are similar",
                "similar (here: 2 dB)",
                m.similar_when_specular,
                SOLVER,
            ),
            Claim(
                "the gain over the two is up to 14 dB",
                "14 dB",
                partial(m.largest_gain, paper=14.0),
                SOLVER,
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
                        TABLES,
                    ),
                    Claim(
                        f"{model}: harmless for diffuse materials",
                        "similar (here: not worse by 2 dB)",
                        partial(m.weighting_harmless, model=model),
                        TABLES,
                    ),
                )
            ),
            Claim(
                "critical even for angles up to 80 degrees only",
                "better (here: more than 2 dB)",
                m.weighting_restricted,
                TABLES,
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
                OPPONENT,
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
                    TABLES,
                )
                for name in FAILURES
            ),
            *(
                Claim(
                    f"the bivariate model remedies {name}",
                    "better (here: more than 2 dB)",
                    partial(m.bivariate_gain, material=name, saves=True),
                    TABLES,
                )
                for name in FAILURES
            ),
            *(
                Claim(
                    f"the bivariate model lacks fidelity for {name}, a diffuse one",
                    "worse than independent-g",
                    partial(m.bivariate_gain, material=name, saves=False),
                    TABLES,
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
                TABLES,
            ),
            Claim(
                "for some materials even better than the bivariate model",
                "some",
                m17.sometimes_above_bivariate,
                TABLES,
            ),
            Claim(
                f"{peng2017.MUCH_BETTER} is much better than by independent-g",
                "much better (here: more than 2 dB)",
                partial(m17.gain, material=peng2017.MUCH_BETTER, large=True),
                SOLVER,
            ),
            *(
                Claim(
                    f"{name} is not much better than by independent-g",
                    "no much improvement (here: not by 2 dB)",
                    partial(m17.gain, material=name, large=False),
                    SOLVER,
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
