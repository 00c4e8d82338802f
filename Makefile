# make render: the first picture.  make test: everything, on every OpenCL runtime here.  make lint, make package, make clean.

PYTHON ?= python3
VENV := .venv
SETTINGS := setup.py setup.cfg pyproject.toml
CL_SCENES := $(wildcard scenes/*.json)

.PHONY: render test lint package clean

render: $(VENV)/installed
	mkdir -p out
	$(VENV)/bin/lumiere render scenes/cornell.json -o out/cornell.png -o out/cornell.exr

# TESTS: arguments for pytest. RUNTIMES: fail where fewer OpenCL runtimes are found.
test: $(VENV)/installed-test
	$(VENV)/bin/python tools/run_tests.py $(if $(RUNTIMES),--expect $(RUNTIMES)) -- $(TESTS)

lint: $(VENV)/installed-test
	$(VENV)/bin/ruff check .
	$(VENV)/bin/python tools/check_cl.py $(CL_SCENES)

package: $(VENV)/installed-test
	$(VENV)/bin/python tools/check_package.py

clean:
	rm -rf $(VENV) build dist out *.egg-info .pytest_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

$(VENV)/bin/python:
	$(PYTHON) -m venv $(VENV)

$(VENV)/installed: $(SETTINGS) | $(VENV)/bin/python
	$(VENV)/bin/pip install --quiet --editable ".[pocl]"
	touch $@

$(VENV)/installed-test: $(SETTINGS) | $(VENV)/bin/python
	$(VENV)/bin/pip install --quiet --editable ".[pocl,test]"
	touch $@ $(VENV)/installed
