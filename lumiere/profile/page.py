"""A profile as one HTML page that needs no other file."""

from __future__ import annotations

from html import escape
from typing import Any

from lumiere.profile.bins import bins
from lumiere.profile.measure import Profile
from lumiere.profile.plot import bounces, colors, lanes, population, shares, whole
from lumiere.profile.report import (
    BOUNCE_COLUMNS,
    COLUMNS,
    MOVED_COLUMNS,
    PROGRAM_COLUMNS,
    bounce_cells,
    findings,
    headline,
    moved_cells,
    number,
    percent,
    program_cells,
    stage_cells,
)
from lumiere.profile.summary import BOUNCES

ROUNDS_CLOSE = 16
"""Rounds of the timeline that shows each launch."""

ROUNDS_SHOWN, ROUNDS_LISTED = 300, 64

STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; margin: 2em auto; max-width: 1180px; padding: 0 1em; color: #1a1a1a; background: #fff }
h1 { font-size: 1.4em } h2 { font-size: 1.1em; margin-top: 2em; margin-bottom: .2em }
svg { width: 100% } svg text { font: 12px system-ui, sans-serif; fill: #333 } svg text.on { fill: #fff } svg text.dark { fill: #333 }
.grid { stroke: #e4e4e4 } .batch { stroke: #999; stroke-dasharray: 4 3 } .alive { fill: #9ecae1 } .new { fill: #08306b }
.key-alive { background: #9ecae1 } .key-new { background: #08306b }
table { margin-top: .8em; border-collapse: collapse; font-size: 13px } th, td { padding: 2px 9px; text-align: right; white-space: nowrap }
td { border-bottom: 1px solid #eee } th:first-child, td:first-child { text-align: left } .scroll { overflow-x: auto }
.dot { display: inline-block; width: .7em; height: .7em; margin-right: .4em }
p.how { margin: .2em 0 .6em; color: #444 } .legend { margin-right: 1.2em }
"""


def _table(head: list[str], rows: list[list[str]]) -> str:
    cells = "".join("<tr>" + "".join(f"<td>{value}</td>" for value in row) + "</tr>" for row in rows)
    return f'<div class="scroll"><table><tr>{"".join(f"<th>{escape(c)}</th>" for c in head)}</tr>{cells}</table></div>'


def _section(title: str, how: str, *body: str) -> str:
    return f'<h2>{escape(title)}</h2><p class="how">{escape(how)}</p>{"".join(body)}'


def _share_of(part: int, whole: int) -> str:
    return percent(part / whole) if part else "–"


def page(profile: Profile, told: dict[str, Any]) -> str:
    """The HTML text of a profile and its summary."""
    stages = [row["stage"] for row in told["stages"]]
    color_of = colors(stages)
    dots = {stage: f'<span class="dot" style="background:{color_of[stage]}"></span>' for stage in stages}
    launches = profile.run.launches
    close = [launch for launch in launches if launch.batch == 0 and launch.round < ROUNDS_CLOSE and launch.stage != "accumulate"]
    rounds = [stage for stage in stages if stage != "accumulate"]
    listed = bins(told["rounds"], rounds, ROUNDS_LISTED)
    legend = "".join(f'<span class="legend">{dots[stage]}{escape(stage)}</span>' for stage in stages)
    seconds = {row["stage"]: row["seconds"] for row in told["stages"]} | {"idle": told["seconds"]["idle"]}
    body = [
        "<h1>Where the time goes</h1>", f"<p><b>{escape(headline(told)[0])}</b></p>",
        "<ul>", *(f"<li>{escape(line)}</li>" for line in findings(told)), "</ul>",
        *(f'<p class="how">{escape(line)}</p>' for line in headline(told)[1:]),
        _section("Stages", "The device's time from the first kernel to the last. Every path goes round: generate starts it, extend traces its ray, "
                 "shade or escape adds light and chooses what is next, connect traces the ray to a light. Grey: the device was idle.",
                 shares(seconds)),
        _table(list(COLUMNS), [[dots[row["stage"]] + escape(cells[0]), *map(escape, cells[1:])]
                               for row in told["stages"] for cells in [stage_cells(row)]]),
        _table(list(MOVED_COLUMNS), [[dots[row["stage"]] + escape(cells[0]), *map(escape, cells[1:])]
                                     for row in told["stages"] for cells in [moved_cells(row)]]),
        '<details open=""><summary>What the columns mean</summary><ul>', *(f"<li>{escape(text)}</li>" for text in told["definitions"]), "</ul></details>",
        _section("Timeline of the whole render", "Left to right, in slices of equal time: the colours say which stages the device worked on in a "
                 "slice, white that it idled.", f"<p>{legend}</p>", whole(launches, stages)),
        _section(f"Timeline of the first {len({launch.round for launch in close})} rounds", "Each bar is one launch; point at it for its round, "
                 "time and items. Empty space between bars that follow each other is idle time.", lanes(close, rounds, profile.counts)),
        _section("Bounces", f"Above: how many rays (light) and shadow rays (dark) are traced at each bounce. Below: the time that the bounce took, by "
                 f"stage, in the colours of the timelines. {BOUNCES}",
                 f'<p><span class="legend"><span class="dot key-alive"></span>rays</span>'
                 f'<span class="legend"><span class="dot key-new"></span>shadow rays</span>{legend}</p>', bounces(told["bounces"], rounds)),
        _table(list(BOUNCE_COLUMNS), [list(map(escape, bounce_cells(row))) for row in told["bounces"]]),
        _section("Where paths go", "Of what waits for a stage, the share that it hands on to each other stage; the rest of it ends there. A path that is "
                 "shaded may both go on (extend) and send a shadow ray (connect).", _table(
                     ["from", *(f"to {stage}" for stage in rounds if stage != "generate")],
                     [[dots[row["stage"]] + escape(row["stage"]),
                       *(_share_of(row["out"].get(stage, 0), row["items"]) for stage in rounds if stage != "generate")]
                      for row in told["stages"] if row["stage"] in rounds])),
        _section("Population by round", "How many paths are alive in each round, dark the ones that were started in it. Where few are alive a "
                 "large device starves: those rounds cost launches and give little. A dashed line begins a batch; a bar may stand for several "
                 "rounds (means).",
                 population(bins(told["rounds"], rounds, ROUNDS_SHOWN))),
        _section("Rounds", "Items in and milliseconds of each stage; means and sums where rounds are taken together.", _table(
            ["round", "batch", "paths alive", *(f"{stage}, items" for stage in rounds), *(f"{stage}, ms" for stage in rounds)],
            [[part.label, str(part.batch), f"{part.paths:,.0f}", *(f"{part.items[s]:,.0f}" for s in rounds),
              *(number(1e3 * part.seconds[s]) for s in rounds)] for part in listed])),
        _section("Programs", "A program is one kernel of one stage, built for what this scene has.", _table(
            [*PROGRAM_COLUMNS, "state read, bytes/item", "state written, bytes/item"],
            [[dots[row["stage"]] + escape(cells[0]), *map(escape, cells[1:]), str(row["state_read_per_item"]), str(row["state_written_per_item"])]
             for row in told["stages"] for cells in [program_cells(row)]])),
    ]
    return (f'<!doctype html><html lang="en"><meta charset="utf-8"><title>Profile of {escape(told["scene"] or "a scene")}</title>'
            f"<style>{STYLE}</style><body>{''.join(body)}</body></html>\n")
