# SPDX-License-Identifier: GPL-3.0-or-later
"""`realmodel check-data` prints the problems in the data of a project."""

import pytest
from realmodel.batch.command import main
from test_hole_files import PROJECT
from test_reported_boreholes import collars, intervals

GIVEN = '{ collars = "c.csv", intervals = "i.csv" }'


@pytest.mark.parametrize(
    ("more", "status", "words"),
    [
        ("", 0, ["no problems"]),
        (
            "H0,0,10,A\n",
            0,
            ["i.csv\n  line 17, hole 'H0' at 0, 'A': the interval of line 2 again (repaired)"],
        ),
        (
            "H0,0,10,A\nH1,5,12,A\nH9,0,1,A\nH2,40,41,tuff\n",
            1,
            [
                "hole 'H1' from 10 to 12: intervals of 'A' and 'B' overlap, lines 6 and 18 (left out)",
                "line 19, hole 'H9' at 0, 'A': it has no collar in",
                "rock 'r'\n  line 20, hole 'H2' at 40, 'tuff': this is no block",
                "problems, 3 left out",
            ],
        ),
    ],
)
def test_problems_by_file(write, capsys, more, status, words):
    write("c.csv", collars())
    write("i.csv", intervals() + more)
    project = write("p.toml", PROJECT.format(boreholes=GIVEN))
    assert main(["check-data", str(project)]) == status
    printed = capsys.readouterr().out
    for text in words:
        assert text in printed


def test_data_that_are_refused_are_a_problem(write, capsys):
    write("c.csv", collars().replace("hole", "a"))
    write("i.csv", intervals())
    project = write("p.toml", PROJECT.format(boreholes=GIVEN))
    assert main(["check-data", str(project)]) == 1
    assert "the header has no column hole" in capsys.readouterr().out


def test_wrong_usage(write, capsys):
    assert main(["check-data"]) == 2
    assert main(["check-data", str(write("p.toml", "x"))]) == 1
