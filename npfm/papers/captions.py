"""Which materials a figure shows: those of the paper's caption, or the nearest in diffuseness."""

from collections.abc import Collection, Sequence

#: Materials that captions and text of Bagher et al. 2016 name, by figure, in their order there.
CAPTIONS = {
    3: ("gold-metallic-paint2",),
    5: ("aluminium", "violet-rubber", "polyurethane-foam"),
    6: ("aluminium", "violet-acrylic", "polyurethane-foam"),
    7: ("nickel", "color-changing-paint1", "maroon-plastic", "white-fabric2"),
    9: (
        "nylon",
        "polyethylene",
        "silver-metallic-paint",
        "yellow-plastic",
        "red-specular-plastic",
    ),
    12: ("color-changing-paint3", "two-layer-gold", "specular-yellow-phenolic", "red-fabric"),
    13: ("brass", "black-obsidian", "aluminium", "silicon-nitrade", "gold-metallic-paint2"),
    14: ("specular-yellow-phenolic",),
    15: ("nickel", "color-changing-paint1", "maroon-plastic", "white-fabric2"),  # as Figure 7
}
_MERL = """
    steel specular-white-phenolic chrome tungsten-carbide specular-black-phenolic
    specular-maroon-phenolic chrome-steel specular-green-phenolic green-plastic ss440
    specular-violet-phenolic specular-blue-phenolic black-obsidian maroon-plastic
    red-specular-plastic specular-yellow-phenolic aventurnine blue-acrylic aluminium hematite
    silicon-nitrade green-acrylic brass violet-acrylic specular-orange-phenolic alumina-oxide
    white-acrylic specular-red-phenolic red-metallic-paint white-marble green-metallic-paint2
    yellow-phenolic red-phenolic pink-jasper blue-metallic-paint2 gray-plastic
    gold-metallic-paint3 black-phenolic grease-covered-steel yellow-matte-plastic white-paint
    gold-metallic-paint2 alum-bronze two-layer-gold two-layer-silver color-changing-paint1
    color-changing-paint3 nickel pvc color-changing-paint2 purple-paint fruitwood-241 nylon
    delrin white-diffuse-bball cherry-235 neoprene-rubber green-metallic-paint teflon
    silver-metallic-paint pure-rubber silver-paint blue-rubber blue-metallic-paint
    black-oxidized-steel gold-paint ipswich-pine-221 dark-specular-fabric gold-metallic-paint
    natural-209 colonial-maple-223 pink-plastic violet-rubber special-walnut-224 pearl-paint
    yellow-plastic yellow-paint red-plastic pickled-oak-260 light-red-paint
    silver-metallic-paint2 orange-paint dark-red-paint dark-blue-paint polyethylene black-fabric
    green-fabric polyurethane-foam black-soft-plastic white-fabric2 red-fabric beige-fabric
    light-brown-fabric pink-felt blue-fabric white-fabric green-latex pink-fabric red-fabric2
    pink-fabric2
"""
_OWN = """
    mirror-metal car-paint snooker-ball hazy-chrome reflective-tape tarnished-bronze
    blue-plastic pearl-paint rough-gold nylon pink-felt chalk terracotta satin-copper
    dark-rubber
"""
#: Materials by increasing diffuseness (equation 19 of the naive fit, mean of the channels): of the
#: MERL database in neural form, and of the project's own.
BY_DIFFUSENESS = _MERL.split(), _OWN.split()


def chosen(wanted: Sequence[str], available: Collection[str]) -> list[str]:
    """Materials to show in place of some wanted ones.

    A wanted material that is available is used; for another one, the available material that is
    nearest in rank, each at most once and none that is wanted itself.

    Parameters
    ----------
    wanted : sequence of str
        As in `CAPTIONS`.
    available : collection of str
        Materials of the run.

    Returns
    -------
    list of str
        In the order of `wanted`; shorter if there are fewer materials.
    """
    free = [name for name in sorted(available) if name not in wanted]
    shown = []
    for name in wanted:
        if name in available:
            shown.append(name)
        elif free:
            nearest = min(
                free, key=lambda other: abs(_rank(other, available) - _rank(name, wanted))
            )
            free.remove(nearest)
            shown.append(nearest)
    return shown


def _rank(name: str, others: Collection[str]) -> float:
    """Place in an order by diffuseness, from 0 to 1; of an unknown name, among `others` by name."""
    known = (order for order in BY_DIFFUSENESS if name in order)
    order = next(known, sorted(others))
    return (order.index(name) + 0.5) / len(order)
