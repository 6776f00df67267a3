# make run    the paper's comparison on a native FMU; make test  the test suite; both in .venv (make test ARGS='-k robot' picks)
# make reports  every study that ships, in full, and what is committed of them; STUDIES='noise matched' runs these alone
# make coverage  the tests of CI with what they cover, which takes half as long again
PYTHON ?= python3
VENV := .venv
ARGS ?= -n auto
BIN := $(VENV)/bin
# The matrices are small: threads of the linear algebra would only wait for each other.
export OPENBLAS_NUM_THREADS ?= 1

.PHONY: run test coverage lint docs reports schema clean
run: $(VENV)/installed
	$(BIN)/brunovsky build -o build
	$(BIN)/brunovsky compare comparisons/paper.toml -o build/paper

test: $(VENV)/installed-tests
	$(BIN)/python -m pytest $(ARGS)

coverage: $(VENV)/installed-tests
	$(BIN)/python -m pytest -n auto -m 'not slow' --cov --cov-report=term:skip-covered -q

lint: $(VENV)/installed-dev
	$(BIN)/ruff check . && $(BIN)/ruff format --check . && $(BIN)/mypy

docs: $(VENV)/installed-dev
	$(BIN)/sphinx-build -W --keep-going -b html docs docs/_build/html

# After a change of what a study file may hold.
schema: $(VENV)/installed
	$(BIN)/brunovsky schema > comparisons/study.schema.json

reports: $(VENV)/installed
	$(BIN)/python docs/refresh_reports.py $(STUDIES)

clean:
	rm -rf build docs/_build $(VENV)

$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "brunovsky needs Python 3.11 or newer; name one with make PYTHON=python3.12"; exit 2; }
	$(PYTHON) -m venv $(VENV)

# One mark for each set of extras, a larger set marks the smaller ones too; a newer pyproject.toml or constraints.txt
# installs again.
$(VENV)/installed: EXTRAS :=
$(VENV)/installed-tests: EXTRAS := [test]
$(VENV)/installed-tests: SMALLER := $(VENV)/installed
$(VENV)/installed-dev: EXTRAS := [dev]
$(VENV)/installed-dev: SMALLER := $(VENV)/installed $(VENV)/installed-tests
$(VENV)/installed $(VENV)/installed-tests $(VENV)/installed-dev: pyproject.toml constraints.txt | $(BIN)/python
	$(BIN)/python -m pip install --disable-pip-version-check --progress-bar off -q -c constraints.txt -e '.$(EXTRAS)'
	@touch $@ $(SMALLER)
