"""The page's style sheet: light and dark paper, screen and print."""

from hthor.report.html import matplotlib_svg

_RULES = """
*{box-sizing:border-box}
html{-webkit-text-size-adjust:100%}
body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.55 Charter,"Bitstream Charter",Georgia,serif}
main{max-width:62rem;margin:0 auto;padding:2.5rem 1.5rem 4rem}
h1{font-size:1.7rem;line-height:1.25;margin:0 0 .4rem}
h2{font-size:1.2rem;margin:3rem 0 .6rem;padding-top:.7rem;border-top:1px solid var(--line)}
h2 span{color:var(--soft);font-weight:normal;margin-right:.35rem}
h3{font-size:1rem;margin:1.6rem 0 .4rem}
p,ul{max-width:46rem;margin:.6rem 0}
.soft,figcaption,caption,footer,dt{color:var(--soft)}
.lead{font-size:1.06rem}
.note{border-left:3px solid var(--line);padding-left:.8rem;color:var(--soft)}
dl{display:grid;grid-template-columns:max-content 1fr;gap:.1rem 1.2rem;margin:1rem 0;font-size:.9rem}
dd{margin:0;overflow-wrap:anywhere}
nav{font-size:.9rem;margin:1.2rem 0}
nav a{color:var(--oracle);text-decoration:none;margin-right:1rem;white-space:nowrap;display:inline-block}
nav a:hover{text-decoration:underline}
.wide{overflow-x:auto;margin:1rem 0;width:fit-content;min-width:100%;max-width:calc(100vw - 3rem)}
.wide{position:relative;left:50%;transform:translateX(-50%)}
table{border-collapse:collapse;font:.8rem/1.4 system-ui,Arial,sans-serif;font-variant-numeric:tabular-nums}
caption{text-align:left;padding:0 0 .45rem;font:.9rem/1.45 Charter,"Bitstream Charter",Georgia,serif}
th,td{padding:.2rem 1rem .2rem 0;text-align:left;vertical-align:top}
th:last-child,td:last-child{padding-right:0}
thead th{vertical-align:bottom;font-weight:600;border-top:2px solid var(--ink);border-bottom:1px solid var(--ink)}
tbody tr:first-child>*{padding-top:.35rem}
tbody tr:last-child>*{padding-bottom:.4rem;border-bottom:2px solid var(--ink)}
tbody th{font-weight:normal}
.n{text-align:right;white-space:nowrap}
thead .n{white-space:normal}
td b,tbody th{white-space:nowrap}
caption span{display:block;position:sticky;left:0;max-width:calc(100vw - 2rem)}
td i{font-style:normal;color:var(--soft);margin-left:.15rem}
td small,th small{display:block;font-size:.86em;line-height:1.3;color:var(--soft)}
td.v{white-space:nowrap}
td.v>span{display:inline-block;min-width:2.9em;text-align:right}
td.v small,th.v{padding-left:.55em}
.high td.v>span{min-width:0;font-weight:600}
.high td,.high th{padding-right:.65rem}
.high td.v i{display:block;margin-left:0}
.high td.v small,.high th.v{padding-left:0}
tr.band>th{padding-top:.6rem;font-style:italic;white-space:normal;color:var(--soft)}
tr.band:not(:first-child)>th{border-top:1px solid var(--line)}
b{font-weight:600}
b.good{color:var(--oracle)}
b.bad{color:var(--published)}
b.quiet{color:var(--soft);font-weight:normal}
figure{margin:1.6rem 0}
figure svg{display:block;width:100%;height:auto;font-family:system-ui,"Helvetica Neue",Arial,sans-serif}
figcaption{font-size:.86rem;line-height:1.45;max-width:46rem;margin-top:.3rem}
footer{margin-top:3rem;padding-top:.7rem;border-top:1px solid var(--line);font-size:.85rem}
code,pre{font:.84em/1.45 ui-monospace,"DejaVu Sans Mono",Menlo,monospace}
code{overflow-wrap:anywhere}
pre{background:var(--shade);padding:.6rem .8rem;overflow-x:auto;white-space:pre-wrap;overflow-wrap:anywhere}
details{margin:1rem 0}
summary{cursor:pointer;color:var(--oracle);font-size:.9rem}
@media print{
 main{max-width:none;padding:0}
 body{font-size:10pt}
 nav{display:none}
 figure,tr,.wide{break-inside:avoid}
 h2,h3{break-after:avoid}
 .wide,.art{overflow:visible}
 table{font-size:7.5pt}
 details::details-content{content-visibility:visible;block-size:auto}
 summary{display:none}
}
"""


def css(more: str = "") -> str:
    """The whole sheet, with a page's own rules ``more``. Paper is always light in print."""
    light = "".join(f"--{name}:{colour};" for colour, name in matplotlib_svg.VARIABLES.items())
    dark = "".join(f"--{name}:{matplotlib_svg.DARK[colour]};" for colour, name in matplotlib_svg.VARIABLES.items())
    return (
        f":root{{color-scheme:light dark;{light}}}\n"
        f"@media screen and (prefers-color-scheme:dark){{:root{{{dark}}}}}{_RULES}{more}"
    )
