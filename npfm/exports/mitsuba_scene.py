"""A folder that renders at once: a scene of Mitsuba 3, a material, and the few lines that start it.

The material is the fit itself, looked up and sampled by the BSDF ``npfm`` of
`npfm.exports.mitsuba`, which is why npfm has to be there; `npfm.exports.bsdf` writes what Mitsuba
reads alone.
"""

import shutil
from collections.abc import Sequence
from pathlib import Path

from npfm.exports.sources import Source
from npfm.fitting.fits import FIT
from npfm.reflectance.merl import BINARY
from npfm.storage.files import Kind, marked, replacing

NAME = "mitsuba"
ABOUT = "a scene of Mitsuba 3 with the fit in it, which renders at once"
SUFFIX = ""
TABLES = True
SCENE, START, MATERIAL = "scene.xml", "render.py", "material"
MARK = "Written by npfm."
#: What lies in such a folder; whoever has put something else there keeps it.
FILES = {SCENE, START, f"{MATERIAL}{FIT.suffix}", f"{MATERIAL}{BINARY.suffix}", "picture.exr"}

#: A ball on a floor, in dim even light and under a lamp that highlights show.
SCENE_TEXT = f"""\
<!-- {MARK} python {START} renders it, or any program that has called
     npfm.exports.mitsuba.register() before. -->
<scene version="3.0.0">
    <default name="spp" value="256"/>
    <default name="size" value="256"/>
    <integrator type="path">
        <integer name="max_depth" value="8"/>
    </integrator>
    <sensor type="perspective">
        <float name="fov" value="32"/>
        <transform name="to_world">
            <lookat origin="0, 1.2, 4.6" target="0, 0.05, 0" up="0, 1, 0"/>
        </transform>
        <sampler type="independent">
            <integer name="sample_count" value="$spp"/>
        </sampler>
        <film type="hdrfilm">
            <integer name="width" value="$size"/>
            <integer name="height" value="$size"/>
        </film>
    </sensor>
    <emitter type="constant">
        <rgb name="radiance" value="0.4"/>
    </emitter>
    <shape type="rectangle">
        <transform name="to_world">
            <scale value="0.8"/>
            <lookat origin="-2, 3.5, 2.5" target="0, 0, 0" up="0, 1, 0"/>
        </transform>
        <emitter type="area">
            <rgb name="radiance" value="20"/>
        </emitter>
    </shape>
    <shape type="rectangle">
        <transform name="to_world">
            <scale value="20"/>
            <rotate x="1" angle="-90"/>
            <translate y="-1"/>
        </transform>
        <bsdf type="diffuse">
            <texture type="checkerboard" name="reflectance">
                <rgb name="color0" value="0.15"/>
                <rgb name="color1" value="0.35"/>
                <transform name="to_uv">
                    <scale value="40"/>
                </transform>
            </texture>
        </bsdf>
    </shape>
    <shape type="sphere">
        <bsdf type="npfm">
            <string name="filename" value="{{material}}"/>
        </bsdf>
    </shape>
</scene>
"""
START_TEXT = f'''\
"""{MARK} Renders the scene beside it: python {START} [samples a pixel] [picture.exr].

It needs pip install 'npfm[mitsuba]', and is fast where there is an LLVM (docs/bounces.md of npfm).
"""

import sys
from pathlib import Path

import mitsuba as mi

from npfm.exports.mitsuba import register

register()
folder = Path(__file__).resolve().parent
samples = sys.argv[1] if len(sys.argv) > 1 else "256"
picture = sys.argv[2] if len(sys.argv) > 2 else str(folder / "picture.exr")
scene = mi.load_file(str(folder / "{SCENE}"), spp=samples)
mi.util.write_bitmap(picture, mi.render(scene))
print(f"wrote {{picture}}")
'''


def _is_scene(path: Path) -> bool:
    """Whether a folder, no link, has what npfm wrote and no more."""
    if path.is_symlink() or not path.is_dir() or {p.name for p in path.iterdir()} - FILES:
        return False
    return all(marked(MARK.encode())(path / name) for name in (SCENE, START))


KIND = Kind("a scene of Mitsuba", SUFFIX, _is_scene)


def write(path: str, sources: Sequence[Source]) -> str:
    """Write the folder; say how to render it."""
    [source] = sources
    kind = FIT if source.is_fit else BINARY
    name = f"{MATERIAL}{kind.suffix}"
    with replacing(path, KIND) as folder:
        folder.mkdir()
        shutil.copyfile(source.path, folder / name)
        (folder / SCENE).write_text(SCENE_TEXT.format(material=name), encoding="ascii")
        (folder / START).write_text(START_TEXT, encoding="ascii")
    return f"python {Path(path) / START} renders it"
