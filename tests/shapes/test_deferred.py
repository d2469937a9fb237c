"""Shapes load trimesh without what they do not need of scipy and others, and nobody is the poorer for it."""

import subprocess
import sys

import pytest


def fresh(script):
    """What a script prints in a new interpreter."""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return done.stdout.split()


SHAPES = "import sys\nfrom sailviz.shapes import planets, primitives, sails, tethers\n"
PARTS = ("scipy.spatial", "scipy.optimize", "scipy.ndimage", "scipy.sparse", "scipy.linalg", "networkx", "lxml.etree")


def test_drawing_every_shape_loads_none_of_what_is_put_off():
    script = SHAPES + (
        "primitives.vertex_normals(sails.film()), sails.booms(), sails.vanes()\n"
        "tethers.wheel_hub(), planets.globe(b'')\n"
        f"print(*[m for m in {PARTS} if m in sys.modules] or ['none'])"
    )
    assert fresh(script) == ["none"]


def test_trimesh_finds_what_was_put_off_when_it_needs_it():
    script = SHAPES + (
        "import trimesh\n"
        "hull = tethers.satellite_panels().convex_hull\n"
        "print(hull.is_watertight, trimesh.convex.QhullError.__name__, trimesh.base.cKDTree.__name__)\n"
        "print('scipy.spatial' in sys.modules, 'scipy.optimize' in sys.modules)\n"
        "print(round(trimesh.creation.icosphere().bounding_sphere.volume, 1))"
    )
    assert fresh(script) == ["True", "QhullError", "cKDTree", "True", "False", "4.2"]


def test_trimesh_walks_graphs_and_writes_and_reads_3mf_with_what_was_put_off():
    pytest.importorskip("lxml")
    script = SHAPES + (
        "import io, trimesh\n"
        "box = trimesh.creation.box(extents=[2.0, 3.0, 4.0])\n"
        "turned = box.copy()\n"
        "turned.faces[0] = turned.faces[0][::-1]\n"
        "trimesh.repair.fix_winding(turned)\n"
        "print(box.vertex_adjacency_graph.number_of_edges(), turned.is_winding_consistent)\n"
        "print('lxml.etree' in sys.modules)\n"
        "again = trimesh.load_scene(io.BytesIO(box.export(file_type='3mf')), file_type='3mf')\n"
        "print(round(again.volume, 6), trimesh.exchange.threemf.etree is sys.modules['lxml.etree'])"
    )
    assert fresh(script) == ["18", "True", "False", "24.0", "True"]


def test_the_library_is_told_at_once_what_is_not_installed():
    script = (
        "from sailviz.shapes.deferred import deferred\n"
        "with deferred('nobody', 'not_installed_anywhere', 'xml.dom'):\n"
        "    try:\n        import not_installed_anywhere\n    except ImportError:\n        print('absent')\n"
        "    from xml import dom\n    print(type(dom).__name__)"
    )
    assert fresh(script) == ["absent", "DeferredModule"]


def test_others_that_import_scipy_get_scipy():
    script = SHAPES + (
        "from scipy import optimize, spatial\n"
        "print(optimize.brentq(lambda x: x - 2, 0, 5), spatial.cKDTree([[0.0], [3.0]]).query([[2.0]])[1][0])\n"
        "print(type(sys.modules['scipy.spatial']).__name__)"
    )
    assert fresh(script) == ["2.0", "1", "module"]


def test_what_was_loaded_before_is_not_put_off():
    script = (
        "import sys, scipy.spatial\nbefore = scipy.spatial\n" + SHAPES + "import trimesh\n"
        "print(sys.modules['scipy.spatial'] is before, trimesh.base.cKDTree is before.cKDTree)"
    )
    assert fresh(script) == ["True", "True"]


@pytest.mark.parametrize(
    "code",
    [
        "shell('list')",
        "shell('check', 'displaced/circular')",
        "shell('show', 'displaced/circular')",
        "sailviz.simulate(sailviz.load_scene('displaced/heliostationary'))",
        "sailviz.read, sailviz.compare, sailviz.export",
    ],
)
def test_what_draws_nothing_loads_no_meshes(code):
    script = f"""
import contextlib, io, runpy, sys
import sailviz

def shell(*words):
    sys.argv = ["sailviz", *words]
    runpy.run_module("sailviz", run_name="__main__")

with contextlib.redirect_stdout(io.StringIO()) as said, contextlib.suppress(SystemExit):
    {code}
assert said.getvalue() or "shell" not in {code!r}
print(*[name for name in ("trimesh", "sailviz.shapes.primitives") if name in sys.modules] or ["none"])
"""
    assert fresh(script) == ["none"]


def test_a_picture_of_a_run_needs_meshes():
    assert fresh("import sys, sailviz.recording.drawing.drawing\nprint('trimesh' in sys.modules)") == ["True"]
