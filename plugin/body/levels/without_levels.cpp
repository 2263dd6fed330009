// For builds without levels of detail: bodies that need them are rejected (adaptivity.cpp), so none of this is ever called.

#include "archive/archive.h"
#include "body/body.h"
#include "body/levels/levels.h"

namespace pliant {

Levels::Levels( std::shared_ptr<const LevelBase> base, const Lattice& lattice, const Material&, const Adaptivity& settings,
	const std::vector<float>& stiffness, Cut cut ) :
	m_base( std::move( base ) ),
	m_lattice( &lattice ), m_settings( settings ), m_stiffness( &stiffness ), m_cut( std::move( cut ) )
{}

Cut Levels::readCut( Archive& archive, const Octree&, std::vector<std::uint32_t> )
{
	archive.refuse( "This build of the library has no levels of detail." );
	return {};
}

void Levels::archive( Archive& ) {}
void Levels::archiveTables( Archive& ) {}

void Levels::fillNodes( NodeState&, float ) const {}
void Levels::requestSplit( int ) {}
void Levels::requestFinest( int ) {}
void Levels::pin( int ) {}

bool Levels::review( const NodeState&, const AlignedArray<float>&, const AlignedArray<float>&, const std::vector<ThinCell>&, float )
{
	return false;
}

void Levels::apply( NodeState&, LatticeMatcher&, const Material&, TaskRunner*, bool ) {}
void Levels::change(
	NodeState&, LatticeMatcher&, const Material&, const std::vector<std::uint32_t>&, const std::vector<std::uint32_t>&, TaskRunner*, bool )
{}

void Body::addEnergyDebt( const LevelEnergy& ) {}
void Body::reduceEnergyDebt( float, float ) {}

LevelEnergy Body::storedEnergy()
{
	return {};
}

void Body::addEnergyDebtSince( const LevelEnergy& ) {}

double Body::joules( const LevelEnergy&, float, float ) const
{
	return 0.0;
}

Status Levels::validate() const
{
	return {};
}

} // namespace pliant
