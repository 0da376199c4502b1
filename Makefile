# narrows: every target works from a bare clone and can be repeated.
PYTHON ?= python3
BIN := .venv/bin
OUT ?= out

export OMP_NUM_THREADS ?= 1
export PIP_DISABLE_PIP_VERSION_CHECK = 1

.DEFAULT_GOAL := help
.PHONY: help setup setup-view setup-dev demo test fast lint bench lock clean

help: ## list the targets
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed 's/:.*## /\t/' | awk -F'\t' '{printf "  make %-10s %s\n", $$1, $$2}'

setup: .venv/.user-stamp ## make .venv with narrows in its bin, from the lock file
setup-view: .venv/.view-stamp ## add what the page in the browser needs (narrows view)
setup-dev: .venv/.dev-stamp

.venv/bin/python:
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "narrows needs Python 3.11 or newer; call make PYTHON=python3.11")'
	$(PYTHON) -m venv .venv

.venv/.user-stamp: requirements/user.lock pyproject.toml | .venv/bin/python
	$(BIN)/python -m pip install --quiet --require-hashes -r requirements/user.lock
	$(BIN)/python -m pip install --quiet --no-deps --no-build-isolation --editable .
	$(BIN)/narrows plan examples/scenes/door.yaml --planner search --json > /dev/null || true # compiles the search, once
	$(BIN)/narrows plan examples/scenes/tight-door.yaml --json > /dev/null || true # and what tight doors need
	@touch $@

.venv/.view-stamp: requirements/view.lock .venv/.user-stamp
	$(BIN)/python -m pip install --quiet --require-hashes -r requirements/view.lock
	@touch $@

.venv/.dev-stamp: requirements/dev.lock .venv/.user-stamp
	$(BIN)/python -m pip install --quiet --require-hashes -r requirements/dev.lock
	@touch $@

demo: setup ## plan and drive the example door; trajectory, picture and record into out/
	@mkdir -p $(OUT)
	$(BIN)/narrows drive examples/scenes/door.yaml --save-trajectory $(OUT)/door.csv --record $(OUT)/door-record.csv --picture $(OUT)/door.png

lint: setup-dev ## ruff, format check, mypy --strict
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

test: lint ## lint, then every test, slow ones too
	$(BIN)/pytest -n auto -q

fast: setup-dev ## the tests that take seconds
	$(BIN)/pytest -n auto -q -m "not slow"

bench: setup-dev ## benchmarks, with their ratios to the plain formulation
	$(BIN)/pytest tests/benchmarks --benchmark-enable --benchmark-only --benchmark-sort=name

lock: ## write the lock files again (needs uv)
	uv pip compile -q --universal --python-version 3.11 --generate-hashes --no-emit-index-url --no-emit-find-links --no-header pyproject.toml requirements/build.in -o requirements/user.lock
	uv pip compile -q --universal --python-version 3.11 --generate-hashes --no-emit-index-url --no-emit-find-links --no-header pyproject.toml requirements/build.in --extra view -c requirements/user.lock -o requirements/view.lock
	uv pip compile -q --universal --python-version 3.11 --generate-hashes --no-emit-index-url --no-emit-find-links --no-header pyproject.toml requirements/build.in --extra dev --extra view -c requirements/user.lock -o requirements/dev.lock

clean: ## remove .venv and out/
	rm -rf .venv $(OUT)
