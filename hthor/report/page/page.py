"""A report as one page without network access or scripts."""

from collections.abc import Callable, Mapping
from html import escape

from hthor.report.analysis.document import Findings
from hthor.report.html import elements, style
from hthor.report.page import headline, sentences
from hthor.report.page.sections import breakdown, provenance, results, session, trials

_SECTIONS: dict[str, tuple[str, Callable[[Findings, Mapping[str, str]], list[str]]]] = {
    "results": ("Results", results.scores),
    "compared": ("Comparisons", results.comparison),
    "time": ("Time spent", session.time_spent),
    "trust": ("Trust", session.trust),
    "channel": ("Communication, and being in the way", session.communication),
    "difficulty": ("By difficulty and kind of task", breakdown.difficulty),
    "scenes": ("By scene", breakdown.scenes),
    "people": ("By kind of person", breakdown.people),
    "trials": ("Best and worst trials", trials.trials),
    "faults": ("Faults", trials.faults),
    "provenance": ("Where the runs come from", provenance.parts),
}
_RULES = """
main{max-width:50rem;counter-reset:figure table}
p,ul,h1{max-width:none}
.over{font:.8rem system-ui,Arial,sans-serif;letter-spacing:.06em;text-transform:uppercase;color:var(--soft);margin:0}
.lead{font-size:1.12rem;line-height:1.5;margin:.8rem 0}
.facts{color:var(--soft);font-size:.92rem}
table{width:100%}
figcaption,caption{color:var(--ink);max-width:none}
caption span{max-width:min(47rem,calc(100vw - 2rem))}
tbody th{white-space:normal;min-width:5rem}
figure:not(.map)>figcaption{counter-increment:figure}
figure:not(.map)>figcaption::before{content:"Figure " counter(figure) ". ";font-weight:600}
caption{counter-increment:table}
caption span::before{content:"Table " counter(table) ". ";font-weight:600}
figure.map figcaption{font-size:.8rem}
figure.map figcaption code{display:block;color:var(--soft);margin-top:.15rem}
.art{overflow-x:auto}
.maps{display:grid;grid-template-columns:repeat(auto-fill,minmax(20rem,1fr));gap:0 1.6rem}
.maps figure{margin:.5rem 0 .9rem}
.maps svg{border:1px solid var(--line)}
li{margin:.15rem 0}
@media screen and (max-width:46rem){
 main{padding:1.2rem 1rem 3rem}
 h1{font-size:1.4rem}
 figure:not(.map) svg{min-width:36rem}
 .maps{grid-template-columns:1fr}
 .wide thead th{min-width:4.5rem}
 .wide td:not(.n,.v){min-width:8rem}
}
@media print{
 .maps{grid-template-columns:1fr 1fr}
 figcaption,caption{font-size:8pt}
 figure.map figcaption{font-size:7pt}
 @page{size:A4;margin:16mm 15mm}
}
"""


def render(found: Findings, drawings: Mapping[str, str]) -> str:
    """The page as HTML; the same findings give the same bytes.

    Args:
        drawings: SVG elements by the names that `hthor.report.page.figure_index` gives.
    """
    sections = (
        elements.section(number, name, title, *make(found, drawings))
        for number, (name, (title, make)) in enumerate(_SECTIONS.items(), 1)
    )
    title = sentences.page_title(found)
    links = elements.navigation({name: title for name, (title, _) in _SECTIONS.items()})
    body = (_head(found, title), links, *sections, _foot(found))
    return elements.page(title, body, style.css(_RULES), headline.headline(found))


def _head(found: Findings, title: str) -> str:
    return "\n".join(
        (
            elements.paragraph("hthor report", "over"),
            f"<h1>{elements.inside(title)}</h1>",
            elements.paragraph(headline.headline(found), "lead"),
            elements.paragraph(sentences.page_facts(found), "facts"),
            *(elements.paragraph(note, "note") for note in sentences.warnings(found)),
        )
    )


def _foot(found: Findings) -> str:
    said = f"Every number on this page is in report.json beside it, schema {found.schema}; every figure is in figures/."
    return f"<footer>{escape(said)}</footer>"
