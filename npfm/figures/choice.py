"""Which materials a figure shows: those of the paper's caption, or the nearest in diffuseness."""

from collections.abc import Sequence

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
    chrome steel tungsten-carbide chrome-steel ss440 specular-black-phenolic black-obsidian
    specular-green-phenolic specular-blue-phenolic brass silicon-nitrade hematite
    red-metallic-paint specular-violet-phenolic aluminium aventurnine blue-metallic-paint2
    green-plastic specular-maroon-phenolic specular-white-phenolic grease-covered-steel
    blue-acrylic green-acrylic green-metallic-paint2 gold-metallic-paint3 violet-acrylic
    red-specular-plastic maroon-plastic specular-yellow-phenolic red-phenolic
    gold-metallic-paint2 black-phenolic alumina-oxide specular-red-phenolic two-layer-silver
    specular-orange-phenolic two-layer-gold pink-jasper white-marble gray-plastic
    yellow-phenolic pvc white-acrylic color-changing-paint1 color-changing-paint3 nickel
    color-changing-paint2 alum-bronze fruitwood-241 pickled-oak-260 purple-paint
    ipswich-pine-221 yellow-matte-plastic nylon cherry-235 natural-209 silver-metallic-paint
    silver-metallic-paint2 colonial-maple-223 gold-paint gold-metallic-paint blue-metallic-paint
    silver-paint green-metallic-paint pearl-paint red-plastic special-walnut-224 violet-rubber
    delrin neoprene-rubber white-paint black-oxidized-steel black-soft-plastic green-latex
    blue-rubber dark-blue-paint yellow-plastic polyethylene dark-specular-fabric pink-plastic
    red-fabric light-red-paint white-diffuse-bball orange-paint dark-red-paint white-fabric2
    yellow-paint pure-rubber teflon green-fabric pink-fabric2 pink-felt blue-fabric white-fabric
    pink-fabric black-fabric beige-fabric red-fabric2 light-brown-fabric polyurethane-foam
"""
_OWN = """
    mirror-metal hazy-chrome snooker-ball car-paint reflective-tape blue-plastic pearl-paint
    tarnished-bronze rough-gold satin-copper nylon dark-rubber terracotta chalk pink-felt
"""
#: Materials by increasing diffuseness (equation 19 of the naive fit, mean of the channels): of the
#: MERL database in neural form, and of the project's own.
BY_DIFFUSENESS = _MERL.split(), _OWN.split()


def chosen(wanted: Sequence[str], available: Sequence[str]) -> list[str]:
    """Materials to show in place of some wanted ones.

    A wanted material that is available is used; for another one, the available material that is
    nearest in rank, each at most once and none that is wanted itself.

    Parameters
    ----------
    wanted : sequence of str
        As in `CAPTIONS`.
    available : sequence of str
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


def _rank(name: str, others: Sequence[str]) -> float:
    """Place in an order by diffuseness, from 0 to 1; of an unknown name, among `others` by name."""
    known = (order for order in BY_DIFFUSENESS if name in order)
    order = next(known, sorted(others))
    return (order.index(name) + 0.5) / len(order)
