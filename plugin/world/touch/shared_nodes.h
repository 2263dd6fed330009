#pragma once

// How a point of a soft body's surface moves with the nodes around it.

#include "lattice/lattice.h"

namespace pliant {

/// The nodes of a body that a contact acts on: the velocity of a point of its surface is, along the contact's normal, the sum of theirs by
/// `press`, and across it by `rub`; impulses there are shared out by the same (contact_surface.h). Each kind sums to 1.
struct SharedNodes
{
	static constexpr int kMost = 4;
	int count = 0;
	int node[kMost] = {};
	double press[kMost] = {}, rub[kMost] = {};

	/// What acts at a node acts on it alone.
	static SharedNodes only( int own )
	{
		SharedNodes shared;
		shared.count = 1;
		shared.node[0] = own;
		shared.press[0] = shared.rub[0] = 1.0;
		return shared;
	}
	/// u = sum r_j v_j + n n.( sum ( p_j - r_j ) v_j ),   `of`( node ): its velocity, m/s.
	template <class Of>
	Vec3d velocity( const Vec3d& normal, const Of& of ) const
	{
		if ( count == 1 )
		{
			return of( node[0] );
		}
		Vec3d sum = Vec3d::Zero(), more = Vec3d::Zero();
		for ( int j = 0; j < count; ++j )
		{
			const Vec3d v = of( node[j] );
			sum += rub[j] * v;
			more += ( press[j] - rub[j] ) * v;
		}
		return sum + normal.dot( more ) * normal;
	}
};

} // namespace pliant
