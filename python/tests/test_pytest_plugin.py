"""The plugin, tried on small suites: a right renderer and three wrong ones, and a golden."""

from __future__ import annotations

from importlib.metadata import entry_points
from pathlib import Path

import pytest

# An installed package is found by its entry point; a folder on the path is not.
INSTALLED = any(one.name == "splatref" for one in entry_points(group="pytest11"))
PLUGIN = [] if INSTALLED else ["-p", "splatref.pytest_plugin"]

SUITE = """
import numpy as np
import pytest
import splatref as sr

SCENE = sr.Scene.open("sphere", count=2000)
CAMERA = sr.Camera(size=(64, 48))


def draw(**settings):
    return sr.render(SCENE, CAMERA, stages=True, **settings)


def test_right(assert_right):
    verdict = assert_right(SCENE, CAMERA, draw())
    assert verdict.right


def test_narrow_epsilon(assert_right):
    assert_right(SCENE, CAMERA, draw(epsilon="1r"))


def test_upside_down(assert_right):
    planes = {name: plane[::-1] for name, plane in draw().items()}
    assert_right(SCENE, CAMERA, planes)


def test_premultiplied_twice(assert_right):
    planes = dict(draw())
    planes["resolved.RGB"] = planes["resolved.RGB"] * np.float32(0.5)
    assert_right(SCENE, CAMERA, planes, report="mine/page.html")
"""


def test_a_right_renderer_passes_and_three_wrong_ones_fail(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(SUITE)
    found = pytester.runpytest_subprocess(*PLUGIN, "--splatref-reports", "pages")
    found.assert_outcomes(passed=1, failed=3)
    found.stdout.fnmatch_lines(
        [
            "*test_narrow_epsilon*",
            "client *planes of ewa",
            "promise *gpu*",
            "attributes *WRONG in * pixels*",
            "looks like *epsilon is half as wide",
            "wrong: no implementation that keeps the promise can produce this",
            "report *pages*test_narrow_epsilon.html",
            "*test_upside_down*",
            "looks like *rows are flipped*",
        ]
    )
    pages = {path.name for path in (pytester.path / "pages").iterdir()}
    assert pages == {"test_narrow_epsilon.html", "test_upside_down.html"}
    assert "splatref verify: wrong" in (pytester.path / "mine" / "page.html").read_text()
    assert "Traceback" not in found.stdout.str()


def test_the_page_lies_beside_the_artifacts_of_the_test(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(SUITE)
    found = pytester.runpytest_subprocess(
        *PLUGIN, "--basetemp", "artifacts", "-k", "narrow"
    )
    found.assert_outcomes(failed=1, deselected=3)
    assert len(list((pytester.path / "artifacts").rglob("test_narrow_epsilon.html"))) == 1


def test_a_golden_is_blessed_only_on_request(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        """
        import numpy as np
        import os
        import splatref as sr

        def test_picture(golden):
            seed = int(os.environ.get("SEED", "0"))
            scene = sr.Scene.open("sphere", count=900, seed=seed)
            golden("sphere", sr.render(scene, sr.Camera(size=(32, 24))))

        def test_planes(golden):
            golden("planes", {"Z": np.ones((4, 5), np.float32)}, max_ulp=1)
        """
    )

    def run(*more: str) -> pytest.RunResult:
        return pytester.runpytest_subprocess(*PLUGIN, *more)

    folder = pytester.path / "goldens"
    found = run()
    found.assert_outcomes(failed=2)
    found.stdout.fnmatch_lines(["golden sphere: there is no golden yet; --bless writes it"])
    assert not folder.exists(), "nothing is written unasked"
    found = run("--bless")
    found.assert_outcomes(failed=2)
    found.stdout.fnmatch_lines(["blessed: wrote *sphere.exr"])
    run().assert_outcomes(passed=2)
    before = (folder / "sphere.exr").read_bytes()
    pytester._monkeypatch.setenv("SEED", "1")
    found = run()
    found.assert_outcomes(failed=1, passed=1)
    found.stdout.fnmatch_lines(["golden sphere:*", "different: * planes differ", "The golden is *sphere.exr"])
    assert (folder / "sphere.exr").read_bytes() == before
    run("--bless").assert_outcomes(failed=1, passed=1)
    run().assert_outcomes(passed=2)


def test_names_of_goldens_stay_in_their_folder(pytester: pytest.Pytester) -> None:
    pytester.makepyfile('def test_it(golden):\n    golden("../a", {})\n')
    found = pytester.runpytest_subprocess(*PLUGIN, "--bless")
    found.assert_outcomes(failed=1)
    found.stdout.fnmatch_lines(["*give a name of letters, digits*"])


def test_the_assertion_works_without_the_plugin(tmp_path: Path) -> None:
    import splatref as sr

    scene, camera = sr.Scene.open("sphere", count=900), sr.Camera(size=(32, 24))
    wrong = sr.render(scene, camera, stages=True, epsilon="0.5r")
    with pytest.raises(AssertionError, match="WRONG"):
        sr.testing.assert_right(scene, camera, wrong, report=tmp_path / "a" / "b.html")
    assert (tmp_path / "a" / "b.html").exists()
    nothing = {"Z": {"data": wrong["Z"]}}
    assert sr.testing.assert_right(scene, camera, nothing, allow=("undecidable",)).outcome != "wrong"
    with pytest.raises(ValueError, match="give unlike or undecidable"):
        sr.testing.assert_right(scene, camera, nothing, allow=("wrong",))
