# Works with python3 (3.11 or newer), gcc and make; everything else is installed into .venv. Drawing from a checkout takes npm once, too.

PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
MODEL  := models/jiwy/jiwy.csp
VSCODE := editors/vscode
STUDIO := studio
PAGE   := $(STUDIO)/build/index.html
ENGINE := $(STUDIO)/build/engine/cspdiag.zip
HAS_NODE = { node -e 'process.exit(parseInt(process.versions.node) < 20 ? 1 : 0)' && command -v npm; } > /dev/null 2>&1

.DEFAULT_GOAL := help
.PHONY: help setup run test hunt check bench fmt docs site pictures cases grammar check-scripts vscode test-vscode pictures-vscode page studio playground test-studio pictures-studio clean

help: ## Show this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-15s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

setup: $(VENV)/.stamp-dev third-party/VERSIONS ## Create .venv with cspdiag (editable) and the developer's tools

run: $(VENV)/.stamp-run ## Compile JIWY, drive the plant, leave a picture and a summary in build/
	@mkdir -p build
	$(BIN)/cspdiag compile $(MODEL) -o build
	$(BIN)/cspdiag run $(MODEL) --plot build/jiwy.svg --record build/jiwy.csv > build/jiwy.txt 2>&1 \
	    || { cat build/jiwy.txt; exit 1; }
	@cat build/jiwy.txt
	@echo "the picture is build/jiwy.svg, the summary build/jiwy.txt, the controller build/jiwy/"

# Three at once on two cores: many tests wait. Bytecode is written whatever the environment says: every worker would compile all tests again.
test: $(VENV)/.stamp-dev page ## Run the whole test suite
	PYTHONDONTWRITEBYTECODE= $(BIN)/pytest -n 3 --dist worksteal

hunt: $(VENV)/.stamp-dev ## Look for errors in random and damaged programs, for some hours
	THOROUGH=1 $(BIN)/pytest tests/distribution/site/test_commands_of_pages.py tests/analyses/timing tests/analyses/margins/test_turns.py tests/network/checks/samples/test_random_readers.py tests/conformance tests/semantics/test_single_precision.py tests/simulate/faults
	$(BIN)/python -m tests.robustness.hunt --count 100000
	$(BIN)/python -m tests.robustness.test_fixed_programs 20000
	$(BIN)/python -m tests.lsp.hunt
	$(BIN)/python -m tests.proofs.hunt --random 20000
	$(BIN)/python -m tests.proofs.refine.test_random_refinements 10000
	$(BIN)/python -m tests.simulate.exits
	$(BIN)/python -m tests.studio.server.load
	$(BIN)/python -m tests.analyses.timing.hunt --random 5000
	$(BIN)/python -m tests.conformance.random --count 5000
	for programs in nested turns tuned parametrized; do \
	    $(BIN)/python -m tests.conformance.random --programs $$programs --count 2000 || exit 1; done
	for property in deadlock livelock terminates schedulable refines trace; do \
	    $(BIN)/python -m tests.oracle.hunt --property $$property --count 5000 || exit 1; done

check: $(VENV)/.stamp-dev check-scripts ## Format, lint, types (of the page too), import rules, sizes of folders, silent defaults, generated documentation
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python distribution/folder_sizes.py
	$(BIN)/python distribution/silent_defaults.py
	$(BIN)/cspdiag explain --markdown | cmp - docs/diagnostics.md
	PYTHONPATH=. $(BIN)/python distribution/layer_picture.py --check

bench: $(VENV)/.stamp-bench ## Run the benchmarks, peers included
	$(BIN)/cspdiag bench

fmt: $(VENV)/.stamp-dev ## Format the Python and the .csp files
	$(BIN)/ruff check --fix --select I .
	$(BIN)/ruff format .
	$(BIN)/cspdiag fmt $(wildcard models/*/*.csp cspdiag/std/*.csp)

docs: $(VENV)/.stamp-dev ## Write the generated documentation
	$(BIN)/cspdiag explain --markdown > build-diagnostics.tmp
	mv build-diagnostics.tmp docs/diagnostics.md

site: $(VENV)/.stamp-site page ## Build the documentation as a site, build/site/index.html: every program, command and figure of it
	PYTHONPATH=. $(BIN)/python -m distribution.site.build

pictures: $(VENV)/.stamp-dev ## Draw the pictures of the documentation and the models
	PYTHONPATH=. $(BIN)/python distribution/notation_pictures.py
	PYTHONPATH=. $(BIN)/python distribution/model_pictures.py
	PYTHONPATH=. $(BIN)/python distribution/layer_picture.py

cases: $(VENV)/.stamp-dev ## Rewrite the expectations of the literate cases; read the difference
	$(BIN)/pytest tests/test_cases.py --update-cases

grammar: ## Generate the parser for editors; needs tree-sitter-cli 0.26 and node
	cd editors/tree-sitter-csp && tree-sitter generate --abi 14

# What is written in TypeScript: the page of the studio where npm can install it, the extension for VS Code where that was installed.
check-scripts:
	@if ! $(HAS_NODE); then \
	    echo "node 20 and npm check the page of the studio, and are not there: its types and style are not checked"; \
	elif ! $(MAKE) --no-print-directory $(STUDIO)/node_modules/.stamp; then \
	    echo "npm cannot install what checks the page of the studio: its types and style are not checked"; \
	else \
	    $(MAKE) --no-print-directory $(STUDIO)/node_modules/.checked; \
	fi
	@if ! $(HAS_NODE) || [ ! -e $(VSCODE)/node_modules/.stamp ]; then \
	    echo "the extension for VS Code is not checked: \`make vscode\` installs what checks it"; \
	else \
	    $(MAKE) --no-print-directory $(VSCODE)/node_modules/.checked; \
	fi

vscode: $(VSCODE)/node_modules/.checked ## Pack the extension for VS Code: editors/vscode/build/cspdiag.vsix; needs node and npm
	cd $(VSCODE) && npm run --silent package

test-vscode: $(VENV)/.stamp-dev $(VSCODE)/node_modules/.checked $(VSCODE)/test/e2e/node_modules/.stamp ## Test that extension in code-server (300 MB by npm) and chromium
	$(BIN)/pytest -rs tests/editors/test_vscode.py

pictures-vscode: vscode $(VSCODE)/test/e2e/node_modules/.stamp ## Make the pictures of that extension in the documentation; look at them
	cd $(VSCODE) && SCREENSHOTS=build/screenshots npm run --silent test:e2e
	$(BIN)/python distribution/editor_pictures.py vscode $(VSCODE)/build/screenshots

studio: $(STUDIO)/node_modules/.checked ## Build the page of the studio: studio/build; needs node and npm
	cd $(STUDIO) && npm run --silent build

playground: studio $(ENGINE) ## Add to that page the engine that runs in browsers: studio/build/engine

test-studio: $(VENV)/.stamp-dev studio $(ENGINE) ## Test that page in chromium, with all models
	WITH_ALL_MODELS=1 $(BIN)/pytest -rs tests/studio/test_page.py tests/studio/test_browser.py

# What the suite needs to test that page and that engine. Where they cannot be built, those tests are skipped and say so.
page: third-party/VERSIONS
	@if ! $(HAS_NODE); then \
	    echo "node 20 and npm build the page of the studio, and are not there: its tests are skipped"; \
	elif [ ! -d third-party/elkjs ] || ! $(MAKE) --no-print-directory $(STUDIO)/node_modules/.stamp; then \
	    echo "npm cannot install what the page of the studio is built from: its tests are skipped"; \
	else \
	    $(MAKE) --no-print-directory $(PAGE) $(ENGINE); \
	fi

pictures-studio: studio ## Make the pictures of that page in the documentation; look at them
	cd $(STUDIO) && SCREENSHOTS=build/screenshots npm run --silent test:e2e
	$(BIN)/python distribution/editor_pictures.py studio $(STUDIO)/build/screenshots

clean: ## Remove .venv, build/ and the caches
	rm -rf $(VENV) build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache

$(VENV)/bin/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	    || { echo "cspdiag needs Python 3.11 or newer; say which: make PYTHON=/path/to/python3"; exit 1; }
	$(PYTHON) -m venv $(VENV)

$(VENV)/.stamp-run: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[plot,draw]'
	@touch $@

$(VENV)/.stamp-dev: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[plot,dev]'
	@touch $(VENV)/.stamp-run $@

# What pip's build hook could not fetch is tried again, and the reason is printed.
third-party/VERSIONS: distribution/third_party.py | $(VENV)/.stamp-dev
	@$(BIN)/python distribution/third_party.py && touch -c $@ || true

$(VSCODE)/node_modules/.stamp: $(VSCODE)/package-lock.json
	cd $(VSCODE) && npm ci --no-audit --no-fund
	@touch $@

$(STUDIO)/node_modules/.stamp: $(STUDIO)/package-lock.json
	cd $(STUDIO) && npm ci --no-audit --no-fund
	@touch $@

$(STUDIO)/node_modules/.checked: $(STUDIO)/node_modules/.stamp $(STUDIO)/tsconfig.json $(STUDIO)/eslint.config.mjs \
    $(shell find $(STUDIO)/src $(STUDIO)/test editors/vscode/src/webview -type f)
	cd $(STUDIO) && npm run --silent check
	@touch $@

$(VSCODE)/node_modules/.checked: $(VSCODE)/node_modules/.stamp $(VSCODE)/tsconfig.json $(VSCODE)/eslint.config.mjs \
    $(shell find $(VSCODE)/src $(VSCODE)/test -name '*.ts' -not -path '*/node_modules/*')
	cd $(VSCODE) && npm run --silent check
	@touch $@

$(PAGE): $(STUDIO)/node_modules/.stamp $(STUDIO)/index.html $(STUDIO)/esbuild.mjs $(shell find $(STUDIO)/src editors/vscode/src/webview -type f)
	cd $(STUDIO) && npm run --silent build

$(ENGINE): $(STUDIO)/node_modules/.stamp third-party/VERSIONS distribution/playground.py distribution/bytecode.mjs docs/language-in-brief.md \
    $(shell find cspdiag grammars manual models templates -type f -not -path '*/__pycache__/*')
	$(BIN)/python distribution/playground.py

# Its own scripts would also fetch from GitHub, as root only if forced, what the test does without: Kerberos, full-text search.
CODE_SERVER := $(VSCODE)/test/e2e/node_modules/code-server/lib/vscode
$(VSCODE)/test/e2e/node_modules/.stamp: $(VSCODE)/test/e2e/package-lock.json
	@case "$(CURDIR)" in *" "*) echo "node-gyp, which builds parts of code-server, cannot do so in a folder with spaces: $(CURDIR)"; exit 1;; esac
	cd $(VSCODE)/test/e2e && npm ci --ignore-scripts --no-audit --no-fund && npm_config_build_from_source=true npm rebuild argon2
	cd $(CODE_SERVER) && npm install --ignore-scripts --omit=dev --no-audit --no-fund && npm_config_yes=true npm rebuild node-pty @vscode/spdlog native-watchdog
	@touch $@

$(VENV)/.stamp-bench: pyproject.toml | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[bench]'
	@touch $@

$(VENV)/.stamp-site: pyproject.toml | $(VENV)/.stamp-dev
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[site]'
	@touch $@
