"""Follows README.md to the letter: `readme.py [--skip COMMAND]... [--page PAGE]... [FOLDER]`.

Runs every command and snippet that the README shows, in its order and in one shell, as a reader would type them, in a
new folder whose name has spaces. Its first command clones the last commit. Prints what each took; stops at the first
that fails.

Other pages are followed instead with --page, in the order in which they are named. If FOLDER has a clone that was set
up before, they go on there: `readme.py FOLDER && readme.py --page docs/index.md FOLDER`. A page that does not clone
gets a clone.
"""

from __future__ import annotations

import argparse
import re
import shlex
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
NAME, CLONE = "hthor, as a reader has it", "hthor"
"""The folder that a reader is in, and the clone in it."""
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)
INLINE = re.compile(r"`((?:hthor|make|python) [^`]+)`")
NOT_TYPED = ("hthor --install-completion", "hthor eval", "hthor tasks make")
"""Inline words that name a command without its arguments, or change the reader's own shell."""


def commands(text: str) -> list[str]:
    """Every command of a page, in order; a snippet of Python is one command too."""
    found: list[str] = []
    for part in re.split(r"(^```.*?^```)", text, flags=re.MULTILINE | re.DOTALL):
        block = BLOCK.match(part)
        if block is None:
            found += [word for word in INLINE.findall(part) if word not in NOT_TYPED]
        elif block[1] == "python":
            found.append(_python(block[2]))
        elif not block[1]:
            found += [line.partition(" #")[0].strip() for line in block[2].splitlines() if line.strip()]
    return list(dict.fromkeys(word for line in found for word in _alternatives(line)))


def _python(code: str) -> str:
    """What a reader does with a snippet: an agent becomes the file that the commands name, all else is run."""
    return f"{'cat > my_agent.py' if 'class Agent' in code else 'python -'} <<'SNIPPET'\n{code}SNIPPET"


def _alternatives(line: str) -> list[str]:
    """`hthor houses|tasks list` stands for two commands."""
    words = line.split(" ")
    at = next((i for i, word in enumerate(words) if re.fullmatch(r"\w+(\|\w+)+", word)), None)
    if at is None or "\n" in line:
        return [line]
    return [" ".join([*words[:at], choice, *words[at + 1 :]]) for choice in words[at].split("|")]


def filled(command: str, folder: Path) -> str:
    """The command with a page's placeholders replaced by the repository, runs, trials and tasks that are there."""
    command = command.replace("git clone URL", f"git clone --quiet {shlex.quote(str(ROOT))}")
    if not re.search(r"\b(RUN|TRIAL|TASK)\b", command):
        return command
    played = sorted((path.parent for path in folder.glob("runs/*smoke*/run.json")), key=lambda run: run.name)
    mine = [str(run.relative_to(folder)) for run in played if run.name.startswith(("frontier", "oracle"))]
    first, second = mine[0], mine[-1]
    task = next(ROOT.glob("hthor/tasks/**/smoke.json")).read_text().partition('"id":')[2].split('"')[1]
    several = command.replace("RUN...", f"{first} {second}").replace("RUN RUN", f"{first} {second}")
    return re.sub(r"\bTASK\b", task, re.sub(r"\bTRIAL\b", "0", re.sub(r"\bRUN\b", first, several)))


def main() -> int:
    """Run it all; the exit status of the first command that fails."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--skip", action="append", default=[], metavar="COMMAND", help="leave this command out")
    parser.add_argument("--list", action="store_true", help="only print the commands")
    parser.add_argument("--page", action="append", type=Path, metavar="PAGE", help="follow this page, not README.md")
    parser.add_argument("folder", nargs="?", type=Path, help="where to clone to; a temporary folder unless given")
    options = parser.parse_args()
    pages = [(ROOT / page).read_text() for page in options.page or ["README.md"]]
    wanted = [line for page in pages for line in commands(page) if line not in options.skip]
    if options.list:
        sys.stdout.write("\n".join(wanted) + "\n")
        return 0
    place = (options.folder or Path(tempfile.mkdtemp(prefix="hthor readme "))).resolve() / NAME
    place.mkdir(parents=True, exist_ok=True)
    clone = place / CLONE
    clones = any(line.startswith("git clone") for line in wanted[:1])
    if not clones and not clone.is_dir():
        subprocess.run(["git", "clone", "--quiet", str(ROOT), str(clone)], check=True)
    shell = subprocess.Popen(
        ["bash"], cwd=place if clones else clone, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    return _follow(shell, wanted, clone)


def _follow(shell: subprocess.Popen[str], wanted: list[str], folder: Path) -> int:
    """Give one shell the commands one by one, as somebody at a terminal does: `source` has to last."""
    assert shell.stdin
    assert shell.stdout
    whole = time.monotonic()
    for command in wanted:
        line, begin = filled(command, folder), time.monotonic()
        sys.stdout.write(f"\n$ {line}\n")
        sys.stdout.flush()
        shell.stdin.write(f"{{ {line}\n}} 2>&1 </dev/null; echo; echo finished-with $?\n")
        shell.stdin.flush()
        status = 1
        for said in shell.stdout:
            if said.startswith("finished-with "):
                status = int(said.split()[1])
                break
            sys.stdout.write(said)
        took = time.monotonic() - begin
        sys.stdout.write(f"-- exit {status}, took {took:.1f} s, {time.monotonic() - whole:.0f} s since the start\n")
        if status:
            return status
    return 0


if __name__ == "__main__":
    sys.exit(main())
