"""Tables whose heads sort them, as HTML; knows nothing of what is in the cells."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

from hthor.leaderboard.cells import Cell

SORT = """
for(const th of document.querySelectorAll("th[data-k]")){
 const go=()=>{
  const first=th.dataset.k==="-1"?"descending":"ascending";
  const way=Number(th.dataset.k)*(th.getAttribute("aria-sort")===first?-1:1);
  const body=th.closest("table").tBodies[0],at=th.cellIndex,value=row=>Number(row.cells[at].dataset.v);
  const rows=[...body.rows].sort((one,other)=>way*(value(one)-value(other)));
  for(const other of th.parentNode.cells)other.removeAttribute("aria-sort");
  th.setAttribute("aria-sort",way===1?"ascending":"descending");
  body.append(...rows);
 };
 th.tabIndex=0;th.addEventListener("click",go);
 th.addEventListener("keydown",key=>{if(key.key==="Enter"||key.key===" "){key.preventDefault();go();}});
}
"""
_N = ' class="n"'


def table(
    head: Iterable[tuple[str, int, str]],
    lines: Sequence[tuple[str, Sequence[Cell]]],
    *,
    words: Iterable[int],
    named: int = 1,
) -> str:
    """A table whose heads sort it; columns in ``words`` hold no numbers, the one of ``named`` is the row's name."""
    wordy = set(words)
    tops = []
    for place, (word, way, drawn) in enumerate(head):
        sorts = f' data-k="{way}"' if way else ""
        tops.append(
            f'<th scope="col"{"" if place in wordy else _N}{sorts}>{drawn or f"<span>{escape(word)}</span>"}</th>'
        )
    body = []
    for kind, parts in lines:
        held = "".join(_cell(part, place == named, place in wordy) for place, part in enumerate(parts))
        body.append(f"<tr{kind}>{held}</tr>")
    whole = f"<table><thead><tr>{''.join(tops)}</tr></thead>\n<tbody>\n" + "\n".join(body) + "\n</tbody></table>"
    return f'<div class="wide">{whole}</div>'


def _cell(part: Cell, named: bool, wordy: bool) -> str:
    tag = "th" if named else "td"
    kind = ' scope="row"' if named else "" if wordy else _N
    return f'<{tag}{kind} data-v="{part.order:g}">{part.html}</{tag}>'


def fold(title: str, inside: str) -> str:
    """Something that is shown when its title is clicked."""
    return f"<details><summary>{escape(title)}</summary>{inside}</details>"
