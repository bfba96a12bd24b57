# The same verbs for people and for CI. `make help` lists them.
SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DEFAULT_GOAL := help
.DELETE_ON_ERROR:

PYTHON := .venv/bin/python
# Debian's own, so that every machine resolves requirements.lock alike
SYSTEM_PYTHON := /usr/bin/python3.11
export PATH := $(CURDIR)/.venv/bin:$(PATH)
# The compiler cache serves every clone on a machine, not only the folder that filled it.
export CCACHE_BASEDIR := $(CURDIR)
export CCACHE_NOHASHDIR := 1
# Tests start hundreds of Python processes: modules are compiled once, not in each of them.
unexport PYTHONDONTWRITEBYTECODE
PROTOS := $(wildcard proto/nocturne/v1/*.proto)
WEB_SOURCES := $(shell find services/web/src services/web/public -type f 2>/dev/null) \
  $(addprefix services/web/,index.html package.json package-lock.json tsconfig.json vite.config.ts)
CPP_SOURCES := $(shell find worker tests/worker bench -name '*.cpp' -o -name '*.h' 2>/dev/null)
STAMPS := build/stamps
PROCESSES := --numprocesses
NOT_MINUTES := not soak and not references and not peers and not containers and not blender and not roots and not slurm and not postgresql

.PHONY: help packages venv proto web worker programs build dist roots slurm postgres containers demo stop test check check-types check-page check-form test-cpp test-page test-services-at-work test-accuracy test-crossings test-coordinator test-services test-scene test-others heaviest format unit system screenshots visit soak accuracy fuzz fuzz-readers crossings references peers blender stability preflights profile sanitize bench lock contract docs reference-pictures gallery clean

help:  ## This list
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*##/\t/' | expand -t 12

packages:  ## Install the Debian packages that are missing
	@deploy/install-debian-packages.sh build test service

PROJECTS := pyproject.toml hatch_build.py scene/pyproject.toml services/client/pyproject.toml services/api/pyproject.toml worker/pyproject.toml
$(STAMPS)/venv: requirements.lock $(PROJECTS) | packages
	test -x $(PYTHON) || $(SYSTEM_PYTHON) -m venv .venv
	$(PYTHON) -m pip install --quiet --no-deps --require-hashes -r requirements.lock
	mkdir -p build/python $(STAMPS)
	$(PYTHON) -m pip install --quiet --no-deps --no-build-isolation --editable .
	touch $@
venv: $(STAMPS)/venv  ## Python environment in .venv

$(STAMPS)/proto: $(PROTOS) $(STAMPS)/venv
	$(PYTHON) -m grpc_tools.protoc -I proto --python_out=build/python --grpc_python_out=build/python \
	  --mypy_out=quiet:build/python --mypy_grpc_out=quiet:build/python $(PROTOS)
	touch build/python/nocturne/v1/py.typed $@
proto: $(STAMPS)/proto  ## Python code of the contracts

services/web/node_modules/.package-lock.json: services/web/package.json services/web/package-lock.json $(STAMPS)/venv
	npm --prefix services/web ci --no-audit --no-fund --silent
	touch $@
$(STAMPS)/web: services/web/node_modules/.package-lock.json $(WEB_SOURCES)
	npm --prefix services/web run --silent build
	touch $@
web: $(STAMPS)/web  ## The page, in services/web/dist

build/release/build.ninja: worker/CMakePresets.json | packages
	cd worker && cmake --fresh --preset release --log-level=WARNING
worker: build/release/build.ninja  ## The C++ programs and their tests
	@cmake --build build/release -- --quiet
programs: build/release/build.ninja  ## The C++ programs alone
	@cmake --build build/release --target nocturne-worker nocturne-trace nocturne-grid -- --quiet

build: proto web worker  ## Everything

# The scene language, the client, the service with the contracts and the page inside, and the programs with their libraries.
dist: proto web programs  ## Wheels of scene, client, service and programs, and the add-on for Blender, in build/dist
	rm -rf build/dist
	$(PYTHON) worker/make_wheel.py build/dist
	$(PYTHON) -m pip wheel --quiet --no-deps --no-build-isolation --wheel-dir build/dist ./scene ./services/client ./services/api
	$(PYTHON) services/blender/make_zip.py build/dist
	@ls build/dist

roots: dist  ## The wheels in empty Debians without root or network, and by every Python at hand; `mmdebstrap` makes them (minutes)
	pytest -m roots -s tests/installed

slurm: build  ## Workers as an array of a real Slurm of two nodes on this machine (a minute or two)
	@deploy/install-debian-packages.sh slurm
	pytest -m slurm -s tests/slurm

postgres: build  ## The store, the services and the fault matrix with PostgreSQL, a real server (half an hour)
	@deploy/install-debian-packages.sh postgres
	pytest -m postgresql tests/postgresql
	pytest -m "not soak" -p tests.postgresql.everywhere tests/coordinator tests/faults tests/services
	pytest -m "not soak" -p tests.postgresql.everywhere -p tests.postgresql.two_coordinators tests/faults

containers: build  ## Images on a real Docker Engine: compose up, all parts killed, the same bits (half an hour at first)
	pytest -m containers -s tests/containers

demo: proto web programs  ## Start the service, render the Cornell box, show where the image and the page are
	@nocturne demo --data data --port $${NOCTURNE_PORT:-7070} --output build/demo

stop:  ## Stop the service that `make demo` started
	@nocturne down --data data

# One pool of jobs, the longest first. Python's tests are in parts, each of which collects only its own; those of whole services, of
# coordinators and of the page wait most of the time, so there are more jobs than processors, and several processes where a part would
# end last (tests/conftest.py).
PARTS := services-at-work page accuracy crossings others coordinator services scene
IN_services-at-work := tests/system tests/faults
IN_page := tests/web
IN_accuracy := tests/accuracy
IN_crossings := tests/crossings
IN_services := tests/services
IN_coordinator := tests/coordinator
IN_scene := tests/scene
IN_others := tests $(addprefix --ignore ,$(IN_page) $(IN_services-at-work) $(IN_accuracy) $(IN_crossings) $(IN_services) $(IN_coordinator) $(IN_scene))
TEST_PARTS := $(addprefix test-,$(PARTS))
CPU_TIMES := $(CURDIR)/build/cpu-times.txt
JOBS := 9
# What computes gives way to what waits for answers: otherwise a service takes half a minute to load here.
COMPUTES := nice -n 10
GIVES_WAY_test-accuracy := $(COMPUTES)
GIVES_WAY_test-crossings := $(COMPUTES)
GIVES_WAY_test-scene := $(COMPUTES)

test: build  ## All checks and tests
	@rm -f $(CPU_TIMES)
	@$(MAKE) --no-print-directory --jobs $(JOBS) --output-sync $(TEST_PARTS) test-cpp check-types check-page check-form
	@$(PYTHON) -m tests.cpu_times $(CPU_TIMES) 0 12
test-cpp: build
	@$(COMPUTES) ctest --test-dir build/release --output-on-failure --no-tests=error --parallel 2 > build/ctest.log || { cat build/ctest.log; false; }
	@grep "tests passed" build/ctest.log
test-services-at-work: AT_ONCE := --numprocesses 5
test-accuracy test-services: AT_ONCE := --numprocesses 2
$(TEST_PARTS): test-%: build
	@NOCTURNE_CPU_TIMES=$(CPU_TIMES) PYTHONPATH=. $(GIVES_WAY_$@) pytest -p tests.cpu_times -q -m "$(NOT_MINUTES)" $(AT_ONCE) $(IN_$*)

check: build  ## Formatting, lint, types, who may import whom
	@$(MAKE) --no-print-directory --jobs 2 --output-sync check-types check-page check-form
check-types:
	$(COMPUTES) mypy
check-page:
	$(COMPUTES) npm --prefix services/web run --silent check
	$(COMPUTES) npm --prefix services/web run --silent test
check-form:
	@clang-format --dry-run --Werror $(CPP_SOURCES)
	ruff check .
	ruff format --check .
	lint-imports

format:  ## Put code into the agreed form
	@clang-format -i $(CPP_SOURCES)
	ruff check --fix-only --quiet .
	ruff format --quiet .

heaviest: build  ## Python tests and files by the processor time that they take, with all that they start
	@rm -f $(CPU_TIMES)
	@$(MAKE) --no-print-directory --jobs $(JOBS) --output-sync $(TEST_PARTS)
	@$(PYTHON) -m tests.cpu_times $(CPU_TIMES) 40 60

unit: test-cpp  ## Tests of single parts: C++, Python, page
	pytest -m "not system and $(NOT_MINUTES)" $(PROCESSES) 4
	npm --prefix services/web run --silent test

system: build  ## Tests of the whole: service, workers, browser, images
	pytest -m "system and $(NOT_MINUTES)" tests/web
	pytest -m "system and $(NOT_MINUTES)" --ignore tests/web $(PROCESSES) 4

screenshots: build  ## Pictures of the page for docs/how-to/page.md: by its test, then of renders worth looking at (some minutes)
	NOCTURNE_SCREENSHOTS=$(CURDIR)/docs/images/page pytest -m soak tests/web
	$(PYTHON) -m tests.web.pictures docs/images/page

visit: build  ## The page in a browser, every view and every control by keyboard; `make test` visits half of it (a minute)
	pytest -m soak tests/web

soak: build  ## Random faults for SOAK_SECONDS (default 600), and all that takes minutes (a quarter of an hour more)
	pytest -m soak

accuracy: build  ## C++ tests and images against known values with all cases, and four times the samples of `make test` (ten minutes to half an hour)
	NOCTURNE_ACCURACY=1 ctest --test-dir build/release --output-on-failure --no-tests=error
	NOCTURNE_ACCURACY=1 pytest -m "not soak" $(PROCESSES) 4 tests/accuracy tests/crossings tests/scene/test_uncertainty.py tests/bench/test_stops.py

fuzz: build  ## Any calls, messages, scenes and bytes, many times more than in the tests (about 20 minutes)
	NOCTURNE_FUZZ_EXAMPLES=300 pytest tests/services/test_any_calls.py tests/scene/formats/test_any_scene.py \
	  tests/coordinator/test_result_handler.py tests/faults/test_any_order.py tests/faults/test_in_memory.py
	NOCTURNE_FUZZ_TRIES=1000 NOCTURNE_FUZZ_SEED=$$RANDOM pytest tests/system/test_any_bytes.py

fuzz-readers: build  ## Files of every format that is read, made wrong, for ten minutes each (an hour)
	$(PYTHON) -m tests.scene.formats.fuzz --seconds 600

FIRST ?= 0
SCENES ?= 1000
crossings: build  ## SCENES random scenes (default 1000) from seed FIRST, each traced by methods that share little (an hour)
	$(PYTHON) -m tests.crossings --first $(FIRST) --scenes $(SCENES)

references: build  ## Other renderers' scenes against their own reference images (minutes)
	pytest -m references -s

peers: build  ## Exported scenes rendered by another renderer, which is installed into build/peers (minutes)
	$(PYTHON) -m bench.peer.install
	pytest -m peers -s

blender: build  ## Blender's add-on in Blender's own Python module, installed into build/blender; its picture in docs (minutes)
	test -x build/blender/bin/python || $(SYSTEM_PYTHON) -m venv build/blender
	build/blender/bin/pip install --quiet --require-hashes -r tests/blender/requirements.lock
	NOCTURNE_SCREENSHOTS=$(CURDIR)/docs/images/blender pytest -m blender -s tests/blender

stability: build  ## Torture cases by every method; writes docs/explanation/stability.md (some ten minutes)
	$(PYTHON) -m tests.stability

preflights: build  ## What the examples need for 2 %, into bench/results (half an hour)
	$(PYTHON) -m bench.preflights

profile: proto programs  ## What the tracer does in examples, for the compiler that optimises by it: worker/tracing.profdata (some ten minutes)
	@deploy/install-debian-packages.sh profile
	cd worker && cmake --fresh --preset profile --log-level=WARNING
	cmake --build build/profile --target nocturne-trace -- --quiet
	$(PYTHON) -m bench.profile

sanitize: packages  ## C++ tests under the address and undefined-behaviour sanitizers
	cd worker && cmake --fresh --preset sanitize --log-level=WARNING
	cmake --build build/sanitize -- --quiet
	ctest --test-dir build/sanitize --output-on-failure --no-tests=error

bench: build  ## Speed figures, each a line of JSON; charts and latest results in bench/results
	@cmake --build build/release --target nocturne-trace-plain -- --quiet
	$(PYTHON) -m bench
	$(PYTHON) -m bench.suite $(if $(filter full,$(BENCH)),--full)

contract: proto  ## The API's description, its page of routes and the Python client's models, from the REST models
	$(PYTHON) -m nocturne_api.rest.app > build/openapi.json
	mv build/openapi.json docs/reference/openapi.json
	$(PYTHON) -m nocturne_api.rest.routes_page > docs/reference/routes.md
	$(PYTHON) services/client/generate_models.py > build/contract.py
	mv build/contract.py services/client/nocturne_client/contract.py

docs: contract  ## Pages that are generated from the code, the documentation site in build/docs-site; runs the tutorials
	$(PYTHON) -m nocturne_scene.document.reference docs/reference
	$(PYTHON) -m typer nocturne_client.cli.app utils docs --name nocturne --title "All commands and options" \
	  > docs/reference/commands.md
	$(PYTHON) -m examples.gallery --page
	$(PYTHON) -m sphinx --fail-on-warning --keep-going --quiet -c docs -d build/docs-doctrees . build/docs-site
	NOCTURNE_SITE=$(CURDIR)/build/docs-site pytest --quiet -m soak tests/docs

reference-pictures: build  ## Pictures of the scene reference that are missing, into docs/images/scene (minutes)
	$(PYTHON) -m examples.reference_pictures

gallery: build  ## Pictures of examples whose entry in examples/gallery.toml is new, and docs/gallery.md (minutes)
	$(PYTHON) -m examples.gallery

COMPILE := build/lock/bin/pip-compile --quiet --generate-hashes --no-reuse-hashes --no-header --strip-extras \
  --no-emit-index-url --no-emit-find-links --no-annotate --allow-unsafe

lock:  ## Pin the newest versions that the packages allow
	$(SYSTEM_PYTHON) -m venv build/lock && build/lock/bin/pip install --quiet pip-tools
	$(COMPILE) --upgrade --extra dev --output-file requirements.lock pyproject.toml
	$(COMPILE) --constraint requirements.lock --output-file requirements-runtime.lock pyproject.toml

clean:  ## Remove everything that was built
	rm -rf build .venv services/web/dist services/web/node_modules
