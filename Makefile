# Everything runs in .venv, which each target sets up first; needed are make and Python 3.11, 3.12 or 3.13 (make PYTHON=/path/to/python: that one).

SCENE ?= tennis_racket
RATE ?= 1000
DURATION ?= 20
SEED ?= 1
COUNT ?= 100

# A ROS that is sourced in the shell hides the wheels of .venv or makes them load what they do not have.
FOREIGN = PYTHONHOME PYTHONPATH LD_LIBRARY_PATH AMENT_PREFIX_PATH CMAKE_PREFIX_PATH COLCON_PREFIX_PATH RMW_IMPLEMENTATION \
    ROS_DISTRO ROS_VERSION ROS_PYTHON_VERSION _ROS_WHEELS_BOOTSTRAP_COMPLETE
LEFT_BEHIND := $(strip $(foreach name,$(FOREIGN),$(if $($(name)),$(name))))
ifneq ($(LEFT_BEHIND),)
$(info Unset for this run, they belong to another installation: $(LEFT_BEHIND))
endif
unexport $(FOREIGN)
# without it each of some hundred processes would read every source anew
unexport PYTHONDONTWRITEBYTECODE
export AMENT_PREFIX_PATH := $(CURDIR)/.venv

PYTHON_VERSIONS = 3.11 3.12 3.13
COLCON = env -u AMENT_PREFIX_PATH .venv/bin/colcon --log-base .cache/colcon/log
COLCON_FOLDERS = --build-base .cache/colcon/build --install-base .cache/colcon/install
NO_NOBLE = { echo 'TEST-NOBLE DID NOT RUN: nothing is known about Ubuntu 24.04 from this machine' >&2; exit 1; }
# worksteal leaves the tests of a file in one process: they share fixtures and compiled kernels;
# three processes for two cores, since many tests wait for nodes; each process imports and lists all tests
# the second limit ends a worker that hangs inside a library, where it hears no signal
PYTEST = python -m pytest --numprocesses 3 --dist worksteal --timeout 300 -o faulthandler_timeout=700 -o faulthandler_exit_on_timeout=true --ignore test/test_installed.py

.PHONY: help run view sweep-demo test lint package unit test-noble test-kilted test-machines test-orders test-cold mutants soak figures docs bench bench-target bench-node bench-choice study study-check study-full pins pins-kilted pins-noble pins-docs clean

help: ## this list
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/make \1\t\2/p' Makefile | expand -t 20

run: .venv/run.stamp ## the node on SCENE (tennis_racket) at RATE (1000) Hz for DURATION (20) s; its recording, report and figure
	@.venv/bin/python -m rigid_body_sim run --scene $(SCENE) --rate $(RATE) --duration $(DURATION)

view: .venv/run.stamp ## a page in which SCENE (tennis_racket) moves and is pushed with the mouse
	@.venv/bin/python -m rigid_body_sim view $(SCENE)

sweep-demo: .venv/run.stamp ## a stability map on a Dask cluster of two worker processes: the sleeping top, to .cache/sleeping_top.zarr
	@mkdir -p .cache
	@rm -rf .cache/sleeping_top.zarr
	@.venv/bin/python examples/sweep_on_dask.py config/sweeps/sleeping_top.yaml .cache/sleeping_top.zarr

test: .venv/test.stamp ## everything, side by side: ruff, mypy, pytest, colcon build and test of the package
	@$(MAKE) --no-print-directory --jobs 3 lint unit package

unit: .venv/test.stamp ## pytest
	.venv/bin/$(PYTEST)

lint: .venv/test.stamp ## ruff; mypy on the public interface and the contracts
	.venv/bin/ruff check .
	.venv/bin/mypy

package: .venv/test.stamp ## colcon build, and colcon test of what was installed
	$(COLCON) build --base-paths . $(COLCON_FOLDERS)
	$(COLCON) test --base-paths . $(COLCON_FOLDERS) --event-handlers console_direct+ --return-code-on-test-failure \
	    --pytest-args test/test_installed.py --timeout 300

mutants: .venv/test.stamp ## COUNT (100) random changes of the code, drawn by SEED (1): at least 95 % are found by a test
	.venv/bin/python test/mutants.py --seed $(SEED) --count $(COUNT)

soak: .venv/test.stamp .cache/mcap_core/stamp ## what takes long: 1000 cut files, 13,000 damaged ones, @mcap/core; 1e8 ticks, 100,000 scene files, two hours of the node; 600 random scenes and 100 on a plane beside a truth; millions of arguments of each function; mutants
	RIGID_BODY_SIM_SOAK=1 .venv/bin/python -m pytest --numprocesses 2 --timeout 7200 \
	    test/recording test/analysis test/hard_cases test/study test/node test/test_digests.py test/test_docs.py \
	    test/compilation test/mechanics test/numerics test/integrators test/motions test/scene test/choice test/simulation test/view test/sweeps test/theory test/test_extending.py
	.venv/bin/python bench/choice_random.py --count 300
	.venv/bin/python bench/choice_random.py --new --count 100
	.venv/bin/python bench/choice_random.py --slowing --count 100
	.venv/bin/python bench/choice_random.py --let-go --count 100
	.venv/bin/python bench/plane_random.py --count 100
	@$(MAKE) --no-print-directory mutants

test-machines: .venv/test.stamp ## the bits as on other machines: processors, C library, BLAS, NumPy, Pythons, ARM64 emulated; docs/machines.md anew
	.venv/bin/python test/machines.py; good=$$?; .venv/bin/python docs/make_machines.py && exit $$good

test-orders: .venv/test.stamp ## pytest in three random orders, each with NumPy and its BLAS as on an older processor
	for one in 1:Prescott 2:Nehalem 3:Haswell; do \
	    OPENBLAS_CORETYPE=$${one#*:} NPY_DISABLE_CPU_FEATURES='X86_V3 X86_V4 AVX512_ICL AVX512_SPR' \
	    .venv/bin/$(PYTEST) --random-order --random-order-seed=$${one%:*} || exit 1; done

test-cold: .venv/test.stamp ## each test file alone, with an empty cache of compiled kernels: hours
	.venv/bin/python test/cold.py

test-noble: .venv-noble/stamp .venv-noble-numba/stamp ## pytest on Python 3.12 with the versions of Ubuntu 24.04, with and without numba
	AMENT_PREFIX_PATH=$(CURDIR)/.venv-noble-numba .venv-noble-numba/bin/$(PYTEST)
	AMENT_PREFIX_PATH=$(CURDIR)/.venv-noble .venv-noble/bin/$(PYTEST)

test-kilted: .venv-kilted/stamp ## the tests of the node on ROS 2 Kilted
	AMENT_PREFIX_PATH=$(CURDIR)/.venv-kilted .venv-kilted/bin/$(PYTEST) test/node test/cli/test_run.py test/test_ros.py

figures: .venv/run.stamp ## figures and tables of README and docs anew
	.venv/bin/python docs/make_figures.py

docs: .venv-docs/stamp ## the pages as a site, in .cache/site: tutorial, how-to, reference, explanation; no network once .venv-docs is there
	.venv-docs/bin/python -m sphinx --quiet --fail-on-warning --write-all --fresh-env --builder html docs .cache/site
	@echo 'Open .cache/site/index.html'

bench: .venv/run.stamp ## cost of one state in closed form; energy over a million steps; instructions of a step; recordings: writing, size, reading; sweeps
	.venv/bin/python bench/closed_forms.py
	.venv/bin/python bench/energy.py
	.venv/bin/python bench/unstable_starts.py
	.venv/bin/python bench/instructions.py
	.venv/bin/python bench/recordings.py
	.venv/bin/python bench/smooth_scenes.py
	.venv/bin/python bench/expressions.py
	.venv/bin/python bench/ensembles.py
	.venv/bin/python bench/sweeps.py --only overhead dask

bench-target: .venv/run.stamp ## closed forms, ensembles and stepped scenes as on a processor with AVX2, beside this one; bench/beside.py OTHER_TREE: beside another version
	.venv/bin/python bench/beside.py avx2

bench-node: .venv/run.stamp ## cost of the node beside the floor: the same bytes published, and nothing else; cost of commands; parts of a tick at each accuracy
	.venv/bin/python bench/node.py
	.venv/bin/python bench/commands.py
	.venv/bin/python bench/tick.py

study: .venv/run.stamp ## what accuracy costs in time: four problems, our methods; table, JSON and figure in study/
	.venv/bin/python -m rigid_body_sim work_precision --quick --output study

study-check: .venv-peers/stamp ## the harness beside published figures of peers: within a factor of 2, or why
	.venv-peers/bin/python bench/published.py

bench-choice: .venv/run.stamp ## what auto chooses on scenes outside its table: errors and cost
	.venv/bin/python bench/choice.py

study-full: .venv-peers/stamp ## the whole suite with the peers, in study-full/; docs/accuracy and docs/hard_cases.md anew
	.venv-peers/bin/python -m rigid_body_sim work_precision --suite --peers --output study-full
	.venv-peers/bin/python docs/make_accuracy.py study-full/work_precision.json
	.venv-peers/bin/python -m rigid_body_sim hard_cases --peers --json > study-full/hard_cases.json
	.venv-peers/bin/python docs/make_hard_cases.py study-full/hard_cases.json

pins: .venv/test.stamp ## requirements/run.txt and test.txt anew from run.in and test.in (with the oldest Python)
	.venv/bin/python requirements/pin.py run
	.venv/bin/python requirements/pin.py test

pins-kilted: .venv-kilted/stamp ## requirements/kilted.txt anew from kilted.in
	.venv-kilted/bin/python requirements/pin.py kilted

pins-noble: .venv-noble/stamp ## requirements/noble.txt anew from noble.in
	.venv-noble/bin/python requirements/pin.py noble

pins-docs: .venv-docs/stamp ## requirements/docs.txt anew from docs.in
	.venv-docs/bin/python requirements/pin.py docs

clean: ## remove the environments and what was built; recordings stay
	rm -rf .venv .venv-docs .venv-kilted .venv-noble .venv-noble-numba .venv-peers .cache

.venv/run.stamp: requirements/run.txt requirements/make_venv.sh
	@requirements/make_venv.sh .venv requirements/run.txt $(PYTHON_VERSIONS)
	@touch $@

.venv/test.stamp: requirements/test.txt .venv/run.stamp
	@requirements/make_venv.sh .venv requirements/test.txt $(PYTHON_VERSIONS)
	@touch $@

.venv-peers/stamp: requirements/peers.txt requirements/make_venv.sh
	@requirements/make_venv.sh .venv-peers requirements/peers.txt $(PYTHON_VERSIONS)
	@touch $@

# a reader of recordings in another language; without npm its tests are skipped
.cache/mcap_core/stamp: test/recording/mcap_core/package.json test/recording/mcap_core/read.mjs
	@mkdir -p .cache/mcap_core
	@cp $^ .cache/mcap_core
	@npm install --silent --no-fund --no-audit --prefix .cache/mcap_core && touch $@ || echo '@mcap/core cannot be installed here (npm): its tests are skipped'

.venv-kilted/stamp: requirements/kilted.txt requirements/make_venv.sh
	@requirements/make_venv.sh .venv-kilted requirements/kilted.txt $(PYTHON_VERSIONS)
	@touch $@

.venv-docs/stamp: requirements/docs.txt requirements/make_venv.sh
	@requirements/make_venv.sh .venv-docs requirements/docs.txt $(PYTHON_VERSIONS)
	@touch $@

.venv-noble/stamp: requirements/noble.txt requirements/make_venv.sh
	@requirements/make_venv.sh .venv-noble requirements/noble.txt 3.12 || $(NO_NOBLE)
	@touch $@

.venv-noble-numba/stamp: requirements/noble-numba.txt .venv-noble/stamp
	@requirements/make_venv.sh .venv-noble-numba requirements/noble.txt 3.12 || $(NO_NOBLE)
	@requirements/make_venv.sh .venv-noble-numba requirements/noble-numba.txt 3.12
	@touch $@
