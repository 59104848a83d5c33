"""Every block of code of the pages runs, from top to bottom."""

from __future__ import annotations

import doctest
import re
import subprocess
import sys
from pathlib import Path

import pytest

import splatref as sr
from conftest import ROOT


def blocks(page: Path) -> list[str]:
    return re.findall(r"^```python\n(.*?)^```", page.read_text(), re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("page", ["docs/python.md", "python/README.md"])
def test_the_code_of_a_page_runs(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    space: dict[str, object] = {"__name__": "page"}
    found = blocks(ROOT / page)
    assert found
    for block in found:
        named = re.match(r"# (test_\w+\.py)\n", block)
        if not named:
            exec(compile(block, page, "exec"), space)
            continue
        (tmp_path / named[1]).write_text(block)
        from test_pytest_plugin import PLUGIN

        def run(*more: str) -> int:
            command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *PLUGIN, *more, named[1]]
            return subprocess.run(command, capture_output=True).returncode

        assert [run(), run("--bless"), run()] == [1, 1, 0], "a golden is blessed"
    if page.startswith("docs"):
        assert {"reference.exr", "preview.png", "verdict.html"} <= {path.name for path in tmp_path.iterdir()}


@pytest.mark.parametrize("module", [sr, sys.modules["splatref._scene"], sr.laws], ids=lambda m: m.__name__)
def test_examples_of_docstrings(module: object) -> None:
    failed, _ = doctest.testmod(module)  # type: ignore[arg-type]
    assert failed == 0


# The last two find no scene: the folder has none.
EXAMPLES = ["torch_rasterizer.py", "choose_a_method.py", "large_torus.py", "many_parts.py", "gaussians_on_cuda.py gsplat .", "gsplat_functions.py ."]


@pytest.mark.parametrize("example", EXAMPLES)
def test_examples_run(example: str, tmp_path: Path) -> None:
    path, *arguments = example.split()
    command = [sys.executable, ROOT / "examples" / "python" / path, *arguments]
    said = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert said.returncode == 0, said.stderr
