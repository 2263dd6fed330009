#pragma once

// Malformed and hostile meshes, made in code, each with the expected result.

#include "test_meshes.h"

#include "pliant/body_template.h"

#include <functional>
#include <string>
#include <vector>

namespace pliant::test {

struct HostileMesh
{
	std::string name;
	std::function<Mesh()> make;
	ResultCode expected = ResultCode::Ok;
	float cellSize = 0.0f; ///< 0: the default, a target of 1 000 cells
	Shell shell = Shell::WhereNeeded;
};

std::vector<HostileMesh> hostileMeshes();

} // namespace pliant::test
