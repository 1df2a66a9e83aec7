# The two commands: `make demo` and `make check`. Everything else is CMake (CMakePresets.json).
JOBS ?= $(shell nproc 2>/dev/null || echo 2)
PREFIX ?= /usr/local
FUZZ_SECONDS ?= 60

.PHONY: all setup demo check check-long fuzz install format clean help
.NOTPARALLEL:

all: setup
	cmake --preset release --log-level=NOTICE
	cmake --build --preset release -j $(JOBS)

setup:
	@tools/setup.sh build

demo: all
	build/lariat demo-model out/demo
	build/lariat run out/demo/uterus.yaml --out out/demo/results
	@echo
	@echo "See it move: open out/demo/results/uterus.pvd in ParaView, Apply, Filters > Common >"
	@echo "    Warp By Vector, Apply, play. Without ParaView: out/demo/results/probes.csv."
	@echo "Pull elsewhere: change out/demo/uterus.yaml (it is commented; make demo writes it anew), then"
	@echo "    build/lariat run out/demo/uterus.yaml --out out/demo/results"
	@echo "At the pace of the clock: build/lariat run out/demo/uterus.yaml --realtime"
	@echo "What else there is: build/lariat --help. Your own mesh: README.md."

check:
	@tools/setup.sh build check
	@JOBS=$(JOBS) tools/check.sh

check-long: setup
	cmake --preset release --log-level=NOTICE
	cmake --build --preset release -j $(JOBS)
	ctest --preset long -j 1

fuzz:
	@tools/setup.sh build fuzz
	@JOBS=$(JOBS) FUZZ_SECONDS=$(FUZZ_SECONDS) tools/fuzz.sh

install: all
	cmake --install build --prefix $(PREFIX)

format:
	git ls-files '*.c' '*.h' | xargs clang-format -i

clean:
	rm -rf build build-asan build-debug build-tsan build-coverage build-fuzz out

help:
	@echo "make          build the library and the command into build/"
	@echo "make demo     build, write the demonstration organ, simulate it"
	@echo "make check    every test, then the fast ones again under the sanitizers"
	@echo "make check-long  what takes longer: every combination, ten million packets"
	@echo "make fuzz     fuzz every reader, FUZZ_SECONDS=$(FUZZ_SECONDS) each"
	@echo "make install  library, header and command under PREFIX=$(PREFIX)"
	@echo "make format   clang-format over all C files"
	@echo "make clean    remove the build folders and out/"
	@echo "Missing Debian packages are installed first. JOBS=$(JOBS) sets the number of jobs."
