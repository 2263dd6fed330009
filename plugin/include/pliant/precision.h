#pragma once

// Encodes Bullet's precision in a parameter type and so in a mangled name: a program compiled for double precision does not link with a
// library built for float, and vice versa. Most of Bullet's own symbols are equal in both, so such a program would link and then crash.

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
