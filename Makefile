# `make run` and `make test` work on a fresh Debian 12 machine. `make help` lists everything.

# More flags for the configuration step, for instance CMAKE_FLAGS=-DTACTUS_WARNINGS_AS_ERRORS=ON
CMAKE_FLAGS ?=
JOBS ?= $(shell nproc)
BUILD := build/release

.DEFAULT_GOAL := help
.PHONY: help run live page site test bench format check clean deps configure

help: ## List these commands
	@sed -n 's/^\([a-z]*\):[^#]*## /\1\t/p' $(MAKEFILE_LIST) | expand -t 10

run: configure ## Build tactus and run the main experiment into out/tapping
	cmake --build --preset release --parallel $(JOBS) --target tactus
	$(BUILD)/bin/tactus run experiments/tapping.toml \
	  --vary control.force_gain=1,3,5,7,10,15 --vary control.cancellation=off,on --out out/tapping --overwrite

live: configure page ## Build tactus and its live page, and serve it: be the operator in a browser
	cmake --build --preset release --parallel $(JOBS) --target tactus
	$(BUILD)/bin/tactus serve experiments/tapping.toml --allow-tuning --page web/dist

# Fetches its tools when they have changed, and builds the page when a source of it has.
page: web/dist/index.html
web/node_modules/.package-lock.json: web/package-lock.json
	@scripts/install-deps --page
	npm ci --prefix web --ignore-scripts --no-audit --no-fund
web/dist/index.html: web/node_modules/.package-lock.json web/index.html $(shell find web/src web/public -type f)
	npm run --prefix web build

site: ## Make the documentation site with the explainer: one static folder, build/site
	@scripts/install-deps --site
	$(MAKE) web/node_modules/.package-lock.json
	CXX_LAUNCHER=$$(command -v ccache) JOBS=$(JOBS) web/kernel/build build/web-kernel
	npm run --prefix web build:explainer
	site/build build/site
	python3 site/check.py build/site
	node site/search.mjs build/site

# A core has three slots for tests (tests/CMakeLists.txt).
test: configure ## Build tactus and its tests, and run them
	cmake --build --preset release --parallel $(JOBS)
	scripts/in-light-session ctest --preset release --parallel $$((3 * $(JOBS)))

bench: configure ## Build the benchmarks, and run those of the servo tick
	cmake --build --preset release --parallel $(JOBS) --target benchmarks
	$(BUILD)/bin/bench_tactus

format: ## Format every source file in place
	@scripts/install-deps --checks
	git ls-files -z '*.hpp' '*.cpp' | xargs -0 clang-format -i

check: ## Run everything that must hold before a change is taken (.ci/run)
	bash .ci/run

clean: ## Remove what was built; results in out/ stay
	rm -rf build web/dist

deps:
	@scripts/install-deps

configure: deps
	cmake --preset release $(CMAKE_FLAGS)
