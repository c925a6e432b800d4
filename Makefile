# `make demo` and `make test` set up everything they need; see README.md.
SHELL := /bin/bash
.DEFAULT_GOAL := help
export PATH := $(CURDIR)/.tools/bin:$(HOME)/.cargo/bin:$(PATH)
CARGO ?= cargo
# What has tests, and the programs that tests drive: benchmarks and studies are no part of it.
TESTED := --lib --bins --tests --example changes_baselines

.PHONY: help setup web build release deb demo test test-rust test-web test-api test-browser lint soak soak-agent bench bench-link bench-latency bench-formats bench-peer bench-scale bench-changes bench-web study study-adjust study-ships study-losses methods clean

help: ## Show what can be made
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed 's/:.*## /\t/' | expand -t 16

setup: ## Check for, and where possible install, compiler, Rust, Node and Python
	@scripts/setup

web/dist/index.html: $(shell find web/src web/public -type f 2>/dev/null) web/index.html web/package-lock.json web/vite.config.ts | setup
	@scripts/web build

web: web/dist/index.html ## Build the dashboard

build: web ## Build the three programs, optimised
	$(CARGO) build --release --locked -p binnacle-server -p binnacle-agent -p binnacle-simulator

release: build ## Put the programs, what they are made of (CycloneDX) and checksums into target/dist
	@scripts/release

deb: setup ## Make the agent's Debian package and check it (ARCH=arm64)
	@scripts/deb $(ARCH)

demo: build ## Sail a simulated fleet and open the dashboard (DAYS=60, PORT=8080)
	@scripts/demo

ifdef CRATE
test: web
	@scripts/test-crate $(CRATE)
else
test: web ## Run every test, real PostgreSQL and Chromium included (CRATE=orders: one crate's)
	@CARGO="$(CARGO)" scripts/test
endif

test-web: web ## Test the dashboard's own functions
	@scripts/web test

test-rust: web ## Test every crate and, end to end, the real programs on both databases
	@scripts/signalk-server >/dev/null
	@scripts/api-clients >/dev/null
	$(CARGO) build --locked --workspace $(TESTED)
	@scripts/with-postgres $(CARGO) test --locked --workspace $(TESTED)
	$(CARGO) test --locked --workspace --doc

test-api: web ## Ask the real server all that its document allows, and much that it does not
	$(CARGO) build --locked --workspace $(TESTED)
	@scripts/fuzz-api

test-browser: web ## Drive the dashboard in a real Chromium
	$(CARGO) build --locked --workspace $(TESTED)
	@scripts/browser-test

lint: web ## Formatter, linters, licences, advisories, documentation
	@scripts/lint

soak: web ## The long tests: many kills, many voyages
	@scripts/signalk-server >/dev/null
	@scripts/api-clients >/dev/null
	$(CARGO) build --locked --workspace $(TESTED)
	@BINNACLE_SOAK=1 scripts/with-postgres $(CARGO) test --locked --workspace $(TESTED)
	@PHASES=examples,coverage,fuzzing,stateful CASES=200 scripts/fuzz-api

soak-agent: setup ## Run the agent at 50 sentences a second and print its memory (MINUTES=60)
	$(CARGO) build --release --locked -p binnacle-agent
	scripts/agent-load.py target/release/binnacle-agent $$(( 60 * $(or $(MINUTES),60) ))

bench: setup ## Run the benchmarks of BENCHMARKS.md
	$(CARGO) bench --locked -p binnacle-compass -p binnacle-analysis -p binnacle-tracking -p binnacle-adjustment -p binnacle-nmea -p binnacle-wire --bench '*'

bench-link: setup ## Count the bytes of a simulated month over a satellite, by profile
	$(CARGO) build --locked --workspace
	BINNACLE_LINK_DAYS=30 $(CARGO) test --locked --workspace --test satellite \
		_cost -- --nocapture --test-threads=1 | grep 'bytes a day'

bench-latency: setup ## Time compass readings through the agent, from datagram to datagram (SECONDS=120)
	$(CARGO) build --release --locked -p binnacle-agent
	scripts/agent-latency.py target/release/binnacle-agent $(or $(SECONDS),120)

bench-formats: setup ## Compare frames with other formats, over stock HTTPS, and with their entropy
	scripts/bench-formats

study: setup ## Measure the estimator on many voyages: coverage, error over the bound
	$(CARGO) run --locked --release -p binnacle-analysis --example study

study-adjust: setup ## Measure plans of adjustments on simulated ships and binnacles
	$(CARGO) run --locked --release -p binnacle-adjustment --example adjust_study

study-ships: setup ## Measure changes and bands on ships with habits and faults of every kind
	$(CARGO) run --locked --release -p binnacle-tracking --example real_ships_study -- --threads 2

study-losses: setup ## Measure what rounding and thinning cost the estimator
	$(CARGO) run --locked --release -p binnacle-wire --example losses

methods: setup ## Compare the published fit, least squares, Huber and Binnacle on voyages
	$(CARGO) run --locked --release -p binnacle-analysis --example methods

bench-scale: setup ## Measure what a new batch costs the server as a ship's history grows
	scripts/bench-scale

bench-peer: setup ## Compare the fit with the same model in statsmodels and NumPy, in pairs
	scripts/bench-peer

bench-changes: setup ## Compare how soon changes are found with simpler detectors (SHIPS=20)
	scripts/bench-changes $(SHIPS)

bench-web: build ## Have Lighthouse judge the dashboard with what `LIVE=no make demo` sailed (RUNS=5)
	scripts/bench-web $(RUNS)

clean: ## Remove what was built (tools in .tools are kept)
	rm -rf target web/dist web/node_modules .demo tests/artefacts
