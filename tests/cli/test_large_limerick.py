"""Long DDAML files, hostile ones too: what grows with the square of their size never ends here."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from dda_command import run_dda
from limerick_files import HAS_XML, INPUT

PATIENCE = 30.0  #: What takes a second takes minutes where its time grows with the square of the size [s]
GEOMETRY = (INPUT / "terrace_ddaml.geo").read_text()
ANALYSIS = (INPUT / "terrace_ddaml.ana").read_text()
#: Elements, and letters: more than a reader keeps of one text unless it is told to
MANY, LONG = 300000, 10000000
#: Put before the list of joints: nothing of it changes the model
FILLING = {
    "blank lines": "\n" * MANY,
    "comments": "<!-- -->\n" * MANY,
    "a long comment": "<!--" + "-\n" * LONG + "-->",
    "instructions": "<?a b?>\n" * MANY,
    "a long instruction": "<?a " + "b\n" * LONG + "?>",
    "unknown elements": "<Foo/>\n" * MANY,
    "unknown elements with ends": "<Foo></Foo>\n" * MANY,
    "unknown elements one in another": "<Foo>" * 90 + "<Foo/>" * MANY + "</Foo>" * 90,
    "many names": "".join(f"<Foo{i}/>" for i in range(90000)),
    "attributes": "<Foo " + " ".join(f'a{i}="1"' for i in range(20000)) + "/>",
    "a long attribute": '<Foo a="' + "\n" * LONG + '"/>',
    "a long tag": "<Foo" + "\n" * LONG + "/>",
    "text": "<Foo>" + "1 2\n" * (LONG // 2) + "</Foo>",
    "pieces of text": "<Foo>" + "<![CDATA[1]]>\n" * MANY + "</Foo>",
}
pytestmark = pytest.mark.skipif(not HAS_XML, reason="the program was built without libxml2")


def check(folder: Path, geometry: str = GEOMETRY, analysis: str = ANALYSIS) -> subprocess.CompletedProcess[str]:
    """Check a model of lines under Shi's scheme."""
    (folder / "long.geo").write_text(geometry)
    (folder / "long.ana").write_text(analysis)
    (folder / "long.nml").write_text("&scene kind = 'lines', geometry = 'long.geo', analysis = 'long.ana' /\n"
                                     "&analysis mode = 'limerick' /\n")
    return run_dda("check", "long.nml", cwd=folder, timeout=PATIENCE)


@pytest.mark.parametrize("filling", FILLING)
def test_filling_changes_nothing_but_the_line_of_what_follows(tmp_path: Path, filling: str) -> None:
    plain = check(tmp_path)
    head, tail = GEOMETRY.split("<Jointlist>")
    head += FILLING[filling]
    done = check(tmp_path, head + "<Here/><Jointlist>" + tail)
    assert done.returncode == 0 and done.stdout == plain.stdout
    line = head.count("\n") + 1
    assert f"long.geo:{line}: warning: the element 'Here'" in done.stderr or "more warnings" in done.stderr
    (tmp_path / "long.geo").write_text("")


@pytest.mark.parametrize("attributes", ["one", "many"])
def test_elements_of_too_many_attributes_are_refused_at_once(tmp_path: Path, attributes: str) -> None:
    elements, each = (1, 300000) if attributes == "one" else (1000, 3000)
    element = "\n<Foo " + " ".join(f'a{i}="1"' for i in range(each)) + "/>"
    done = check(tmp_path, GEOMETRY.replace("<Jointlist>", element * elements + "<Jointlist>"))
    assert done.returncode == 2
    assert re.fullmatch(rf"long.geo:\d+: error: .* attributes, got one of {each}; remove some\n", done.stderr)


def test_too_many_names_are_refused_at_once(tmp_path: Path) -> None:
    names = "".join(f"<Foo{i}/>\n" for i in range(MANY))
    done = check(tmp_path, GEOMETRY.replace("<Jointlist>", names + "<Jointlist>"))
    assert done.returncode == 2
    assert re.fullmatch(r"long.geo:\d+: error: .* different names, got more; .*\n", done.stderr)


def test_many_materials_and_forces_are_read(tmp_path: Path) -> None:
    (stone,) = re.findall(r'<Blockmaterial type="1">.*?</Blockmaterial>', ANALYSIS, re.DOTALL)
    stones = stone.replace(' type="1"', "") * 20000
    (load,) = re.findall(r"<Loadpoint .*?</Loadpoint>", ANALYSIS, re.DOTALL)
    records = "".join(f"{i} 0 0;\n" for i in range(300000))
    loads = load * 20000 + f'<Loadpoint numpoints="300000">{records}</Loadpoint>'
    (point,) = re.findall(r"<Loadpointlist>\s*(<Point>.*?</Point>)", GEOMETRY)
    done = check(tmp_path, GEOMETRY.replace(point, point * 20001),
                 ANALYSIS.replace(stone, stone + stones).replace(load, loads))
    assert done.returncode == 0, done.stderr


def test_many_lines_are_read(tmp_path: Path) -> None:
    # short ones within a block, whose ends are free, cut nothing
    places = (1 + 2 * i / 100000 for i in range(100000))
    lines = "".join(f'<Joint type="1"> {x} 0.5 {x + 1e-5} 0.5 </Joint>\n' for x in places)
    done = check(tmp_path, GEOMETRY.replace("<Jointlist>", "<Jointlist>" + lines))
    assert done.returncode == 0, done.stderr
