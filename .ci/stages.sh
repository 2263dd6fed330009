# shellcheck shell=bash
# What .ci/run and .ci/full share. Read it with `.`, from the repository's folder.

. .ci/parts.sh

unset BUILD_DIR OUT BUILD_TYPE
export CMAKE_ARGS="${CMAKE_ARGS:-} -DPLIANT_UNITY=ON" # for the two commands
began=$SECONDS
table=""

stage() # name command ...
{
	local name=$1 from=$SECONDS
	shift
	echo "=== $name: $*"
	if ! "$@"; then
		printf '%s' "$table"
		echo "=== FAILED: $name, after $(( SECONDS - from )) s" >&2
		exit 1
	fi
	table+=$( printf '%-14s %5d s' "$name" $(( SECONDS - from )) )$'\n'
}

finish()
{
	printf '%s' "$table"
	printf '%-14s %5d s\n' all $(( SECONDS - began ))
}

format()
{
	third_party_glue/install_packages.sh clang-format
	git ls-files -z '*.h' '*.cpp' | xargs -0 clang-format --dry-run -Werror
}

# Every public symbol is documented.
reference()
{
	third_party_glue/install_packages.sh doxygen
	mkdir -p build/reference
	doxygen docs/Doxyfile
}

# The name of the part whose turn it is: see parts.sh.
part_of_turn()
{
	local turn
	if [ "$( git rev-parse --is-shallow-repository )" = true ]; then
		turn=$(( 16#$( git rev-parse HEAD | cut -c 1-6 ) ))
	else
		turn=$( git rev-list --count --first-parent HEAD )
	fi
	echo "${turns[turn % ${#turns[@]}]}"
}
