#pragma once

// Motion of a point of a soft body's surface with the nodes around it.

#include "lattice/lattice.h"

namespace pliant {

/// The nodes that a contact acts on: the velocity of a surface point is the weighted sum of theirs, by `press` along the contact normal and
/// by `rub` across it; impulses are distributed by the same weights (contact_surface.h). Each set of weights sums to 1, pinned nodes
/// included.
struct SharedNodes
{
	static constexpr int kMost = 4;
	int count = 0;
	int node[kMost] = {};
	double press[kMost] = {}, rub[kMost] = {};

	/// A contact that acts on one node alone.
	static SharedNodes only( int own )
	{
		SharedNodes shared;
		shared.count = 1;
		shared.node[0] = own;
		shared.press[0] = shared.rub[0] = 1.0;
		return shared;
	}
	/// u = sum r_j v_j + n n.( sum ( p_j - r_j ) v_j ),   `of`( node ): the node's velocity, m/s.
	template <class Of>
	Vec3d velocity( const Vec3d& normal, const Of& of ) const
	{
		if ( count == 1 && press[0] == 1.0 && rub[0] == 1.0 )
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
	/// Calls add( node, impulse ) with each node's part of an impulse, N s.
	template <class Add>
	void share( const Vec3d& normal, const Vec3d& impulse, const Add& add ) const
	{
		const Vec3d along = normal.dot( impulse ) * normal;
		for ( int j = 0; j < count; ++j )
		{
			add( node[j], rub[j] * impulse + ( press[j] - rub[j] ) * along );
		}
	}
	/// Removes the nodes for which `isRemoved( node )` and keeps the others' weights; returns the velocity of the removed ones' part.
	template <class IsRemoved, class Of>
	Vec3d remove( const Vec3d& normal, const IsRemoved& isRemoved, const Of& of )
	{
		SharedNodes kept, removed;
		for ( int j = 0; j < count; ++j )
		{
			SharedNodes& to = isRemoved( node[j] ) ? removed : kept;
			to.node[to.count] = node[j];
			to.press[to.count] = press[j];
			to.rub[to.count++] = rub[j];
		}
		*this = kept;
		return removed.velocity( normal, of );
	}
};

} // namespace pliant
