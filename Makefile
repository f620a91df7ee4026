# `make demo` runs the main job, `make live` lets you take part yourself, `make test` checks the whole project. For work on hthor itself: `make fmt` formats,
# `make check` is the quick check before a commit, `make nightly` runs the checks that take longer, `make docs` builds the
# documentation site in site/, `make bench` times trials, physics and pictures. All of them make their own .venv with the
# pinned dependencies of constraints.txt.

PYTHON ?= $(shell for p in python3.12 python3.11 python3; do \
  $$p -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 12))' 2>/dev/null && { echo $$p; break; }; done)
BIN := .venv/bin
JOBS ?= $(shell nproc 2>/dev/null || echo 1)

# compiled files save each of the thousands of processes that tests start most of its start
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo savn live page test check nightly fmt lint docs bench install torch clean python

demo: .venv/.installed
	$(BIN)/hthor eval --agent none --agent frontier --agent oracle --humans proxy --suite smoke

# the same tasks with a robot that learned, and with one that goes to the nearest unknown place
savn: .venv/.installed-torch
	$(BIN)/hthor eval --agent none --agent nearest --agent frontier --agent savn --agent oracle --humans proxy --suite smoke

# a page for you, and a robot that helps
live: page
	$(BIN)/hthor live --agent frontier --suite paper

page: .venv/.installed-page
	@$(BIN)/python scripts/build_page.py

test: lint
	@# a file's tests share worlds and runs, so one process does them all
	$(BIN)/pytest -q -n $(JOBS) --dist loadfile -m "not nightly" --durations 25

check: lint
	$(BIN)/pytest -q -n $(JOBS) --dist loadfile -m "not nightly" --quick

# all parts, or one: make nightly PART=redteam
nightly: .venv/.installed-dev
	scripts/nightly.sh $(PART)

lint: .venv/.installed-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	@$(BIN)/python scripts/size_warnings.py

fmt: .venv/.installed-dev
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .
	$(BIN)/python scripts/wrap_markdown.py README.md CONTRIBUTING.md SECURITY.md CODE_OF_CONDUCT.md docs/*.md

docs: .venv/.installed-docs
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict

bench: .venv/.installed-dev
	$(BIN)/python -m benchmarks

install: .venv/.installed

# what robots that learn need, what the page is built and opened with, and the tests of both, which skip without it
torch: .venv/.installed-torch

python:
	@$(if $(PYTHON),$(PYTHON),false) -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 12))' 2>/dev/null \
	  || { echo "hthor needs Python 3.11 or 3.12, and $(if $(PYTHON),$(PYTHON) is neither,none is on the PATH): install one, or name it: make demo PYTHON=/path/to/python3.12" >&2; exit 2; }

.venv/bin/python: | python
	@echo "Making .venv with $(PYTHON)"
	@$(PYTHON) -m venv .venv

.venv/.installed: pyproject.toml constraints.txt | .venv/bin/python
	@$(BIN)/python scripts/install.py
	@touch $@

.venv/.installed-dev: pyproject.toml constraints.txt | .venv/bin/python
	@$(BIN)/python scripts/install.py dev calibration learn live
	@touch .venv/.installed $@

.venv/.installed-torch: pyproject.toml constraints.txt | .venv/bin/python
	@$(BIN)/python scripts/install.py dev browser calibration learn live page sb3 torch
	@touch .venv/.installed .venv/.installed-dev .venv/.installed-page $@

.venv/.installed-page: pyproject.toml constraints.txt | .venv/bin/python
	@$(BIN)/python scripts/install.py live page
	@touch .venv/.installed $@

.venv/.installed-docs: pyproject.toml constraints.txt | .venv/bin/python
	@$(BIN)/python scripts/install.py docs
	@touch .venv/.installed $@

clean:
	rm -rf .venv build dist site hthor/live/page web/node_modules *.egg-info .mypy_cache .pytest_cache .ruff_cache .hypothesis
