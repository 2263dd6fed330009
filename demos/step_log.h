#pragma once

// Times of the parts of each step, and its counts: medians and maxima for the table and summary.json.

#include <pliant/soft_body_world.h>

#include <nlohmann/json_fwd.hpp>

#include <chrono>
#include <string>
#include <vector>

namespace pliant_demos {

inline double secondsSince( std::chrono::steady_clock::time_point begin )
{
	return std::chrono::duration<double>( std::chrono::steady_clock::now() - begin ).count();
}

class StepLog
{
public:
	/// `wallSeconds`: duration of the whole call of stepSimulation.
	void add( const pliant::StepReport& report, double wallSeconds, int rigidContacts );

	/// Skins are computed when they are read, once a frame, not within a step.
	void addSkinning( double seconds ) { m_skinning.push_back( seconds ); }

	std::size_t skinnings() const { return m_skinning.size(); }
	double lastSkinning() const { return m_skinning.empty() ? 0 : m_skinning.back(); }

	int steps() const { return int( m_wall.size() ); }
	double wallSeconds() const;
	int maxSoftContacts() const { return m_maxSoftContacts; }
	int maxContacts() const { return m_maxContacts; }
	int maxSubsteps() const { return m_maxSubsteps; }
	int quarantined() const { return m_quarantined; }
	int unreachableStiffness() const { return m_unreachable; }

	/// ms: the whole step, and the part of it that moves the soft bodies' nodes.
	double medianStep() const;
	double longestStep() const;
	double medianMatching() const;
	/// ms a picture, for all bodies.
	double medianSkinning() const;

	/// Rows of stage, median and maximum, ms.
	std::string table() const;
	nlohmann::json json() const;

private:
	struct Stage
	{
		const char* name;
		double pliant::StepReport::*member;
		std::vector<double> seconds;
	};
	std::vector<Stage> m_stages = { { "forces", &pliant::StepReport::forces, {} }, { "matching", &pliant::StepReport::matching, {} },
		{ "collision", &pliant::StepReport::collision, {} }, { "solve", &pliant::StepReport::solve, {} },
		{ "integrate", &pliant::StepReport::integrate, {} }, { "levels", &pliant::StepReport::levels, {} },
		{ "fracture", &pliant::StepReport::fracture, {} } };
	std::vector<double> m_wall, m_skinning;
	int m_maxSoftContacts = 0, m_maxContacts = 0, m_maxSubsteps = 0, m_quarantined = 0, m_unreachable = 0;
};

} // namespace pliant_demos
