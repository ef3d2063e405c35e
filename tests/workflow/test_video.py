from PIL import Image

from npfm.evaluation import turned_light
from npfm.fitting import iterations

PAGE = "gallery/video/chalk.html"
ANIMATIONS = {"gallery/video/chalk-light.gif", "gallery/video/chalk-starts.gif"}


def test_the_target_follows_a_fit_and_turns_the_light(project):
    results = project.folder / "results" / "tiny"
    planned = project.planned("video")
    assert {PAGE, *ANIMATIONS, "video/scenes/0", "video/scenes/240"} <= planned
    # The run has naive, and what is followed is fitted once.
    assert not any(name.startswith("video/fits/") for name in planned)
    run = project.snakemake("video")
    assert run.returncode == 0, run.stdout + run.stderr
    assert {PAGE, *ANIMATIONS} <= {f"{p.relative_to(results)}" for p in results.glob("**/*.*")}
    assert not [*results.glob("video/scenes/*")]
    found = iterations.load(results / "video/iterations/chalk.npz")
    assert len(found.names) == 8
    shown = turned_light.read(results / "video/frames/chalk.exr")
    assert shown.degrees == (0, 120, 240) and shown.names == ("measured", "independent-g", "naive")
    with Image.open(results / "gallery/video/chalk-light.gif") as animation:
        assert animation.n_frames == 3
    assert project.planned("video") == set()
    script = project.folder / "npfm/exports/gallery/templates/video.js"
    script.write_text(script.read_text() + "// Changed.\n")
    assert project.planned("video") == {PAGE}
    pages = results / "gallery/index.html", results / "gallery/materials/chalk.html"
    run = project.snakemake(*(f"results/tiny/{page.relative_to(results)}" for page in pages))
    assert run.returncode == 0, run.stdout + run.stderr
    assert '"videos":["chalk"]' in pages[0].read_text()
    assert '"video":true' in pages[1].read_text()


def test_a_variant_that_is_none_is_refused(fresh):
    fresh.configure(video=fresh.config["video"] | {"variants": ["naiv"]})
    run = fresh.snakemake("--dry-run", "video")
    assert run.returncode != 0
    assert "video/variants: unknown variant 'naiv'; did you mean naive" in run.stdout + run.stderr
