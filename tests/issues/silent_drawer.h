#pragma once

// A debug drawer that requests all modes and draws nothing.

#include <LinearMath/btIDebugDraw.h>

namespace pliant::test {

struct SilentDrawer : btIDebugDraw
{
	void drawLine( const btVector3&, const btVector3&, const btVector3& ) override {}
	void drawContactPoint( const btVector3&, const btVector3&, btScalar, int, const btVector3& ) override {}
	void reportErrorWarning( const char* ) override {}
	void draw3dText( const btVector3&, const char* ) override {}
	void setDebugMode( int ) override {}
	int getDebugMode() const override { return DBG_DrawWireframe | DBG_DrawAabb | DBG_DrawConstraints | DBG_DrawContactPoints; }
};

} // namespace pliant::test
