"""What objects say of themselves: in a line or two, with their numbers, and in a notebook as tables."""

from __future__ import annotations

import re

import pytest
import test_numbers_out

import contactdd as cd


@pytest.fixture(scope="module")
def path():
    q = cd.Parameter(0.0)
    record = {"force": lambda solution: solution.contact().force}
    return cd.programme(test_numbers_out.blocks(load=q), q, [5.0, 10.0], record=record)


def test_results_tell_their_numbers(path):
    """4 cm² under 10 MPa, uniaxial but for the held sides; no arrays, no addresses in memory."""
    solution = path.solutions[-1]
    contact, surface, body = solution.contact(), solution.contact_surface(), solution.body("lower")
    assert repr(contact) == f"ContactResult({len(contact.x)} points, peak pressure 10, force 40)"
    assert "8 facets: 0 nothing opposite, 0 open, 0 partly closed, 8 closed; force 40" in repr(surface)
    assert f"von Mises up to {10 * (1 - 0.3 / 0.7):.6g}" in repr(body)
    assert "10 to 10" in repr(contact.nodal_field)
    for thing in (contact, surface, body, contact.nodal_field, solution.scene, cd.SCHEMES["chord"], path):
        assert len(repr(thing)) < 400
        assert not re.search(r"array\(|0x[0-9a-f]{6}", repr(thing))


def test_tables_in_a_notebook(path, tmp_path):
    """The same of a solution and of what was saved of it; a load path's steps are rows."""
    solution = path.solutions[-1]
    saved = cd.load_solution(solution.save(tmp_path))
    assert saved._repr_html_() == solution._repr_html_()
    assert "<td>10</td><td>40</td><td>4</td>" in solution._repr_html_()
    assert "<th>parameter</th><th>force</th>" in path._repr_html_()
    assert "<tr><td>5</td><td>20</td></tr><tr><td>10</td><td>40</td></tr>" in path._repr_html_()


def test_steps_have_names(path, tmp_path):
    figure = path.plot_contact(label="{step}) q = {value} MPa")
    assert [text.get_text() for text in figure.axes[0].get_legend().get_texts()] == ["1) q = 5 MPa", "2) q = 10 MPa"]


def test_runs_beside_each_other(tmp_path):
    """Each with the rate of its second half, a geometric sequence's own."""
    histories = {}
    for name, rate in (("slow", 0.8), ("fast", 0.1)):
        histories[name] = cd.History()
        for k in range(1, 13):
            histories[name].append(cd.Record(k, 1.0, rate**k, rate**k, 0.0, 0.0, 0.0, 0.0, k, 0.0))
    figure = histories["slow"].plot(name="slow", beside={"fast": histories["fast"]}, path=tmp_path / "runs.svg")
    told = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
    assert told == ["slow, × 0.8 per iteration", "fast, × 0.1 per iteration"]
    with pytest.raises(ValueError, match="name = 'fast'"):
        histories["slow"].plot(name="fast", beside=histories)
    assert (tmp_path / "runs.svg").read_text().startswith("<?xml")
