# shellcheck shell=bash
# What is too long for every run: .ci/run takes one part of `turns` a change; .ci/full takes all parts. Read it with `.`, from the repository's folder.
#
# Whose turn it is: the number of changes that have landed (commits of the main line, merges counted once) modulo the number of turns. A clone
# without history takes the commit's name instead. Whatever the change touches, each part comes once in so many changes.
#
# A part is a function part_NAME. A part is in `turns` when it is known to fit into the time that .ci/run has left on two processors without a
# compiler's cache; where it takes longer, and longer than the tests by a fifth, the run fails, so that nothing is left out unseen.
readonly turns=( asan_core_1 alone_1 alone_2 asan_core_2 alone_3 alone_4 asan_core_3 alone_5 )
readonly parts=( "${turns[@]}" tsan asan_world_1 double asan_issues_1 clang asan_world_2 tidy asan_issues_2 threadsafe asan_world_3 )

# The parts' settings: .ci/full has them empty, and runs all tests of a part.
slice=${slice-yes}

configure_part() # preset, options for CMake ...
{
	local preset=$1 options=( -DPLIANT_UNITY=ON -DPLIANT_PRECOMPILE=ON -DPLIANT_BUILD_DEMOS=OFF -DPLIANT_BUILD_BENCH=OFF )
	shift
	if command -v ccache > /dev/null 2>&1; then
		options+=( -DCMAKE_CXX_COMPILER_LAUNCHER=ccache )
	fi
	mkdir -p build
	cmake --preset "$preset" "${options[@]}" "$@" > "build/configure-$preset.log" 2>&1 || { cat "build/configure-$preset.log"; return 1; }
}

build_part() # preset, targets ...
{
	local preset=$1
	shift
	cmake --build "build-$preset" --parallel "$( nproc )" --target "$@"
}

test_part() # preset, folder of tests, number of the slice, number of slices, arguments for ctest ...
{
	local preset=$1 folder=$2 number=$3 of=$4 some=()
	shift 4
	if [ -n "$slice" ] && (( of > 1 )); then
		some=( --tests-information "$number,,$of" )
	fi
	ctest --test-dir "build-$preset/tests/$folder" --parallel "$( nproc )" --output-on-failure --no-tests=error --label-exclude '^full$' "${some[@]}" "$@"
}

# --- files without the others of their folder -----------------------------------------------------------------------------------------------
# With PLIANT_UNITY a file may use what another one of its batch includes. `alone K N`: every N-th file, from the K-th on.
alone()
{
	local files
	files=$( git ls-files 'plugin/*.cpp' 'tests/*.cpp' | awk -v k="$1" -v n="$2" 'NR % n == k % n' )
	configure_part release -DPLIANT_UNITY=OFF -DPLIANT_PRECOMPILE=OFF -DPLIANT_BUILD_BENCH=ON -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -B build-alone || return 1
	sed -n 's/^ *"command": "\(.*\)",$/\1/p' build-alone/compile_commands.json | grep -F -f <( sed "s|^| -c $PWD/|" <<< "$files" ) |
		sed 's/ -o [^ ]* -c / -fsyntax-only -c /; s/\\\\"/"/g' | xargs -r -d '\n' -n 1 -P "$( nproc )" sh -c
}
part_alone_1() { alone 1 5; }
part_alone_2() { alone 2 5; }
part_alone_3() { alone 3 5; }
part_alone_4() { alone 4 5; }
part_alone_5() { alone 5 5; }

# --- address and undefined-behaviour sanitizers, assertions on -----------------------------------------------------------------------------
export UBSAN_OPTIONS=print_stacktrace=1

# A turn leaves out the checks of each access through a pointer, which take as long to compile as all others together and find little that
# the address sanitizer does not; .ci/full has them.
configure_asan()
{
	local checks=address,bool,bounds,builtin,enum,float-cast-overflow,float-divide-by-zero,integer-divide-by-zero,nonnull-attribute
	checks+=,return,returns-nonnull-attribute,shift,signed-integer-overflow,unreachable,vla-bound
	configure_part asan ${slice:+"-DPLIANT_SANITIZE=$checks"}
}

asan_core() # folder of tests ...
{
	local folder targets=()
	for folder in "$@"; do
		targets+=( "tests/$folder/all" )
	done
	configure_asan && build_part asan "${targets[@]}" || return 1
	for folder in "$@"; do
		test_part asan "$folder" 1 1 || return 1
	done
}
part_asan_core_1() { asan_core threads lattice adapt; }
part_asan_core_2() { asan_core fracture body; }
part_asan_core_3() { asan_core surface matching; }

asan_world()
{
	configure_asan && build_part asan tests/world/all && test_part asan world "$1" 3
}
part_asan_world_1() { asan_world 1; }
part_asan_world_2() { asan_world 2; }
part_asan_world_3() { asan_world 3; }

asan_issues()
{
	configure_asan && build_part asan tests/issues/all tests/laws/all && test_part asan issues "$1" 2 && test_part asan laws "$1" 2
}
part_asan_issues_1() { asan_issues 1; }
part_asan_issues_2() { asan_issues 2; }

# --- thread sanitizer: the tests of the pool, and every scene on four threads -----------------------------------------------------------------
part_tsan()
{
	local scene frames=${tsan_frames:-6} demos=build-tsan/demos/pliant_demos
	configure_part tsan -DPLIANT_BUILD_DEMOS=ON -DPLIANT_GL=OFF && build_part tsan tests/threads/all pliant_demos || return 1
	test_part tsan threads 1 1 || return 1
	for scene in $( "$demos" --list | cut -d ' ' -f 1 ); do
		echo "--- $scene on four threads"
		"$demos" --scene "$scene" --threads 4 --frames "$frames" --no-render --out "build-tsan/out" > build-tsan/scene.log 2>&1 || { cat build-tsan/scene.log; return 1; }
	done
}

# --- Bullet in double precision ------------------------------------------------------------------------------------------------------------
part_double()
{
	configure_part double && build_part double all || return 1
	test_part double . 1 1 && tests/consumer/run.sh build-double
}

# --- clang: warnings are errors, and the same tests ------------------------------------------------------------------------------------------
part_clang()
{
	third_party_glue/install_packages.sh clang && configure_part clang-release && build_part clang-release all && test_part clang-release . 1 1
}

# --- clang-tidy (.clang-tidy) over every file, and clang's warnings with it ------------------------------------------------------------------
part_tidy()
{
	third_party_glue/install_packages.sh clang clang-tidy || return 1
	configure_part clang-release -DPLIANT_BUILD_DEMOS=ON -DPLIANT_BUILD_BENCH=ON -DPLIANT_PRECOMPILE=OFF -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -B build-tidy || return 1
	# The files that the build compiles, batches of a folder's files among them; not those of one instruction set.
	sed -n 's/^ *"file": "\(.*\)".*/\1/p' build-tidy/compile_commands.json | grep -v -e headers_alone -e /kernels/ | sort -u |
		xargs -n 1 -P "$( nproc )" clang-tidy -p build-tidy --quiet
}

# --- Bullet on several threads, with the thread sanitizer in it and in us ----------------------------------------------------------------------
part_threadsafe()
{
	local bullet=build/bullet-threadsafe flags="-fsanitize=thread -g1"
	third_party_glue/build_bullet.sh "$bullet" -DBULLET2_MULTITHREADING=ON "-DCMAKE_CXX_FLAGS=$flags -w" || return 1
	configure_part tsan -DBULLET_ROOT="$PWD/$bullet/prefix" -DCMAKE_CXX_FLAGS=-DBT_THREADSAFE=1 -B build-threadsafe || return 1
	build_part threadsafe world_test && test_part threadsafe world 1 1 --tests-regex 'ThreadedWorlds|OtherWorlds'
}

# --- random calls of the public functions under the address sanitizer -------------------------------------------------------------------------
random_sequences() # count
{
	configure_asan && build_part asan issues_fuzz && PLIANT_RANDOM_SEQUENCES=$1 build-asan/tests/issues/issues_fuzz
}
