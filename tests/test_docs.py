"""Links, paths and modules that the pages name are there."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/*.md")])
#: What the page on adding a model has the reader make.
TO_BE_MADE = {"npfm/models/schlick.py"}


def anchors(page):
    """Names of the headings of a page, as in links to them."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", h.lower()).strip().replace(" ", "-") for h in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_what_a_page_leads_to_is_there(page):
    text = page.read_text()
    for link, anchor in re.findall(r"\]\(([^)#:]*)(?:#([^)]*))?\)", text):
        target = page.parent / link if link else page
        assert target.exists(), link
        assert not anchor or anchor in anchors(target), f"{link}#{anchor}"
    paths = re.findall(r"`((?:npfm|tests|workflow|benchmarks)/[\w/.-]+)`", text)
    assert [path for path in {*paths} - TO_BE_MADE if not (ROOT / path).exists()] == []


def test_modules_that_docstrings_name_are_there():
    for file in [*PAGES, *ROOT.glob("npfm/**/*.py")]:
        for name in re.findall(r"`(npfm(?:\.\w+)+)`", file.read_text()):
            path = ROOT.joinpath(*name.split("."))
            # A module, a package, or something in a module.
            there = path.with_suffix(".py"), path, path.parent.with_suffix(".py")
            assert any(place.exists() for place in there), f"{file}: {name}"
