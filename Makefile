# The two commands: `make demo` and `make check`. Everything else is CMake (CMakePresets.json).
JOBS ?= $(shell nproc 2>/dev/null || echo 2)
PREFIX ?= /usr/local
FUZZ_SECONDS ?= 60
EMPTY :=
SPACE := $(EMPTY) $(EMPTY)

.PHONY: all setup configure demo check check-long report fuzz deb install format clean help
.NOTPARALLEL:

# What is installed, without the tests, which `make check` builds.
all: setup configure
	@tools/build.sh products $(JOBS)

setup:
	@tools/setup.sh build scan fit web python

configure:
	@cmake --preset release --log-level=NOTICE >/dev/null

# The command and the page only. Without a display the address is printed. DEMO_SECONDS=5 ends it by
# itself.
demo: setup configure
	@tools/build.sh demo $(JOBS)
	@tools/demo.sh $(DEMO_SECONDS)

check:
	@tools/setup.sh build scan fit web python check
	@JOBS=$(JOBS) tools/check.sh

check-long:
	@tools/setup.sh build scan fit web python check
	@JOBS=$(JOBS) tools/check.sh --long

report:
	@tools/setup.sh build scan fit web python check report
	cmake --preset release --log-level=NOTICE
	cmake --build --preset release -j $(JOBS)
	tools/report/run.sh

fuzz:
	@tools/setup.sh build fuzz
	@JOBS=$(JOBS) FUZZ_SECONDS=$(FUZZ_SECONDS) tools/fuzz.sh

# Debian packages, into out/deb.
deb:
	@tools/setup.sh deb
	@tools/web.sh --required
	@tools/deb.sh $(JOBS)

# For all users, whatever umask root has. A prefix may have spaces. Quotes would keep ~ from the
# shell, which not every one resolves before.
install: all
	umask 022 && cmake --install build --prefix $(subst $(SPACE),\$(SPACE),$(PREFIX))

format:
	git ls-files '*.c' '*.h' | xargs clang-format -i

clean:
	rm -rf build build-asan build-debug build-tsan build-coverage build-fuzz out web/dist web/node_modules

help:
	@echo "make          build the library and the command into build/"
	@echo "make demo     build, simulate the demonstration organ in real time, show it in the browser"
	@echo "make check    every test, then the fast ones again under the sanitizers"
	@echo "make check-long  what takes longer, also with the sanitizers: every combination"
	@echo "make report   measure this machine, and make the thesis's tables and figures again: docs/report/"
	@echo "make fuzz     fuzz every reader, FUZZ_SECONDS=$(FUZZ_SECONDS) each"
	@echo "make deb      Debian packages of library, headers, command, viewer and Python module: out/deb/"
	@echo "make install  library, header and command under PREFIX=$(PREFIX)"
	@echo "make format   clang-format over all C files"
	@echo "make clean    remove the build folders and out/"
	@echo "Missing Debian packages are installed first. JOBS=$(JOBS) sets the number of jobs."
