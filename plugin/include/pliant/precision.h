#pragma once

// Bullet's precision, made part of a function's name: a program that sees Bullet in double precision does not link with a library
// built for float, or the other way round. Bullet's own symbols mostly agree in both, so that such a program would link and crash.

namespace pliant {

struct BuiltForFloatBullet
{};

struct BuiltForDoubleBullet
{};

#if defined( BT_USE_DOUBLE_PRECISION )
using BulletPrecision = BuiltForDoubleBullet;
#else
using BulletPrecision = BuiltForFloatBullet;
#endif

} // namespace pliant
