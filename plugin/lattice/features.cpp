// The features of this build: the only file that is compiled with the options.

#include "lattice/features.h"

namespace pliant {

namespace {

struct FeatureInfo
{
	const char* name;
	const char* option;
	bool isEnabled;
};

const FeatureInfo kFeatures[kFeatureCount] = {
	{ "Fracture", "PLIANT_WITH_FRACTURE", PLIANT_WITH_FRACTURE },
	{ "Levels", "PLIANT_WITH_LEVELS", PLIANT_WITH_LEVELS },
	{ "Plasticity", "PLIANT_WITH_PLASTICITY", PLIANT_WITH_PLASTICITY },
	{ "Surface", "PLIANT_WITH_SURFACE", PLIANT_WITH_SURFACE },
	{ "FarLevels", "PLIANT_WITH_FAR_LEVELS", PLIANT_WITH_FAR_LEVELS },
	{ "Clusters", "PLIANT_WITH_CLUSTERS", PLIANT_WITH_CLUSTERS },
	{ "SelfCollision", "PLIANT_WITH_SELF_COLLISION", PLIANT_WITH_SELF_COLLISION },
};

bool isKnown( Feature feature )
{
	return int( feature ) >= 0 && int( feature ) < kFeatureCount;
}

} // namespace

bool hasFeature( Feature feature )
{
	return isKnown( feature ) && kFeatures[int( feature )].isEnabled;
}

const char* toString( Feature feature )
{
	return isKnown( feature ) ? kFeatures[int( feature )].name : "unknown";
}

Status requireFeature( Feature feature )
{
	if ( hasFeature( feature ) )
	{
		return {};
	}
	return Status{ ResultCode::BadArgument,
		std::string( "This build is without " ) + toString( feature ) + ": it was made with " + kFeatures[int( feature )].option +
			"=OFF." };
}

} // namespace pliant
