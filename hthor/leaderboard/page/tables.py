"""Tables whose heads sort them."""

from collections.abc import Iterable, Sequence

from hthor.leaderboard.page.cells import Cell
from hthor.report.html import markup
from hthor.report.html.markup import Markup, Piece, tag

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


def table(
    head: Iterable[tuple[Piece, int]],
    lines: Sequence[tuple[str, Sequence[Cell]]],
    *,
    words: Iterable[int],
    named: int = 1,
) -> Markup:
    """A table whose heads sort it.

    Args:
        head: each column's title and which way it sorts first: 1 up, -1 down, 0 not at all.
        lines: each row's class and cells.
        words: columns that hold no numbers. named: the column that is the row's name.
    """
    wordy = set(words)
    tops = [
        tag("th", tag("span", title), scope="col", class_=None if place in wordy else "n", data_k=way or None)
        for place, (title, way) in enumerate(head)
    ]
    body = (
        tag(
            "tr",
            *(_cell(part, place == named, place in wordy) for place, part in enumerate(parts)),
            class_=kind or None,
        )
        for kind, parts in lines
    )
    return markup.table(tops, body)


def _cell(part: Cell, named: bool, wordy: bool) -> Markup:
    kind = {"scope": "row"} if named else {"class_": None if wordy else "n"}
    return tag("th" if named else "td", part.shown, **kind, data_v=float(part.order))


def fold(title: str, *inside: Piece) -> Markup:
    """Something that is shown when its title is clicked."""
    return tag("details", tag("summary", title), *inside)
