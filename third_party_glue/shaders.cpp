// +-----------------------------------------------------------------------------------------------------------------+
// | A sun with soft shadows, light from the sky that objects above keep away, a little gloss, a filmic curve.        |
// | Light is linear until the last line.                                                                             |
// +-----------------------------------------------------------------------------------------------------------------+

#include "third_party_glue/shaders.h"

namespace pliant_glue {

const char* programDefine( Program program )
{
	switch ( program )
	{
		case Program::Mesh: return "#define MESH\n#define LIT\n";
		case Program::Box: return "#define BOX\n#define INSTANCED\n#define LIT\n";
		case Program::Sphere: return "#define SPHERE\n#define INSTANCED\n#define LIT\n";
		case Program::Ground: return "#define GROUND\n#define LIT\n";
		case Program::Sky: return "#define SKY\n";
		case Program::Line: return "#define LINE\n";
		case Program::ShadowMesh: return "#define MESH\n#define DEPTH_ONLY\n";
		case Program::ShadowInstance: return "#define INSTANCED\n#define DEPTH_ONLY\n";
		case Program::Count: break;
	}
	return "";
}

const char* const kVertexSource = R"(
layout( location = 0 ) in vec3 inPosition;
layout( location = 1 ) in vec3 inNormal;
layout( location = 2 ) in vec3 inAxisX;
layout( location = 3 ) in vec3 inAxisY;
layout( location = 4 ) in vec3 inAxisZ;
layout( location = 5 ) in vec3 inPlace;
layout( location = 6 ) in vec3 inColour;

uniform mat4 uViewProjection;
uniform mat4 uInverseViewProjection;
uniform mat4 uToShadow;
uniform mat4 uToSkyShadow;
uniform vec3 uOrigin;
uniform float uShadowTexel;

out vec3 vWorld;
out vec3 vNormal;
out vec3 vLocal;
out vec4 vShadow;
out vec4 vSkyShadow;
out vec3 vColour;
flat out vec3 vAxisX;
flat out vec3 vAxisY;
flat out vec3 vAxisZ;

void main()
{
#if defined( SKY )
	gl_Position = vec4( inPosition.xy, 1.0, 1.0 );
	vec4 far = uInverseViewProjection * vec4( inPosition.xy, 1.0, 1.0 );
	vWorld = far.xyz / far.w;
	return;
#else
	vec3 world = inPosition + uOrigin;
	vec3 normal = inNormal;
	vColour = inColour;
	#if defined( INSTANCED )
	world = inAxisX * inPosition.x + inAxisY * inPosition.y + inAxisZ * inPosition.z + inPlace;
	vAxisX = inAxisX;
	vAxisY = inAxisY;
	vAxisZ = inAxisZ;
	normal = normalize( inAxisX ) * inNormal.x + normalize( inAxisY ) * inNormal.y + normalize( inAxisZ ) * inNormal.z;
	#endif
	vWorld = world;
	vNormal = normal;
	vLocal = inPosition;
	gl_Position = uViewProjection * vec4( world, 1.0 );
	#if defined( LIT )
	// Looking up a little off the surface keeps a face from shading itself.
	vShadow = uToShadow * vec4( world + normal * uShadowTexel * 1.5, 1.0 );
	vSkyShadow = uToSkyShadow * vec4( world + normal * uShadowTexel * 32.0, 1.0 );
	#endif
#endif
}
)";

const char* const kFragmentSource = R"(
in vec3 vWorld;
in vec3 vNormal;
in vec3 vLocal;
in vec4 vShadow;
in vec4 vSkyShadow;
in vec3 vColour;
flat in vec3 vAxisX;
flat in vec3 vAxisY;
flat in vec3 vAxisZ;

uniform vec3 uEye;
uniform vec3 uToSun;
uniform sampler2DShadow uShadowMap;
uniform sampler2DShadow uSkyShadowMap;
uniform vec2 uShadowMapTexel;
uniform float uFogDistance;

out vec4 outColour;

const vec3 kSun = vec3( 2.45, 2.20, 1.85 );
const vec3 kSkyLight = vec3( 0.40, 0.49, 0.64 );
const vec3 kGroundLight = vec3( 0.22, 0.20, 0.18 );

vec3 skyColour( vec3 direction )
{
	float up = clamp( direction.y * 1.6 + 0.12, 0.0, 1.0 );
	return mix( vec3( 0.78, 0.83, 0.88 ), vec3( 0.36, 0.51, 0.72 ), sqrt( up ) );
}

// A filmic curve (fit of the ACES reference by a quotient of parabolas), then display gamma.
vec3 display( vec3 light )
{
	vec3 x = light * 0.55;
	vec3 film = clamp( x * ( 2.51 * x + 0.03 ) / ( x * ( 2.43 * x + 0.59 ) + 0.14 ), 0.0, 1.0 );
	return pow( film, vec3( 1.0 / 2.2 ) );
}

#if defined( LIT )
float sunSeen()
{
	vec3 p = vShadow.xyz;
	if( any( lessThan( p, vec3( 0.0 ) ) ) || any( greaterThan( p, vec3( 1.0 ) ) ) )
	{
		return 1.0;
	}
	float seen = 0.0;
	for( int y = -1; y <= 1; ++y )
	{
		for( int x = -1; x <= 1; ++x )
		{
			seen += texture( uShadowMap, vec3( p.xy + vec2( x, y ) * uShadowMapTexel * 1.2, p.z ) );
		}
	}
	return seen / 9.0;
}

// How much of the sky is seen straight up, blurred widely: darkens the ground under and beside things.
float skySeen()
{
	vec3 p = vSkyShadow.xyz;
	if( any( lessThan( p, vec3( 0.0 ) ) ) || any( greaterThan( p, vec3( 1.0 ) ) ) )
	{
		return 1.0;
	}
	const vec2 kTaps[7] = vec2[7]( vec2( 0.0, 0.0 ), vec2( 1.0, 0.0 ), vec2( -0.5, 0.87 ), vec2( -0.5, -0.87 ), vec2( -2.1, 0.3 ),
		vec2( 1.3, 1.7 ), vec2( 0.8, -1.95 ) );
	float seen = 0.0;
	for( int k = 0; k < 7; ++k )
	{
		seen += texture( uSkyShadowMap, vec3( p.xy + kTaps[k] * 0.011, p.z ) );
	}
	return seen / 7.0;
}
#endif

#if defined( GROUND )
float gridLine( vec2 at, float spacing, float width )
{
	vec2 cell = at / spacing;
	vec2 wide = fwidth( cell );
	vec2 distanceToLine = abs( fract( cell - 0.5 ) - 0.5 );
	vec2 line = 1.0 - smoothstep( vec2( width / spacing ), vec2( width / spacing ) + wide * 1.2, distanceToLine );
	return max( line.x, line.y ) * clamp( 1.0 - max( wide.x, wide.y ) * 2.0, 0.0, 1.0 );
}
#endif

void main()
{
#if defined( DEPTH_ONLY )
	return;
#elif defined( SKY )
	outColour = vec4( display( skyColour( normalize( vWorld - uEye ) ) ), 1.0 );
#elif defined( LINE )
	outColour = vec4( display( vColour ), 1.0 );
#else
	vec3 normal = normalize( gl_FrontFacing ? vNormal : -vNormal );
	vec3 albedo = vColour;
	float gloss = 0.5;
	#if defined( BOX )
	// Rounded edges without their triangles: the normal of a box whose edges have radius r.
	vec3 size = vec3( length( vAxisX ), length( vAxisY ), length( vAxisZ ) );
	float r = min( 0.018, 0.2 * min( size.x, min( size.y, size.z ) ) );
	vec3 inside = vLocal * size;
	vec3 beyond = sign( vLocal ) * max( abs( inside ) - ( 0.5 * size - r ), 0.0 );
	normal = normalize( vAxisX / size.x * beyond.x + vAxisY / size.y * beyond.y + vAxisZ / size.z * beyond.z );
	gloss = 0.25;
	#elif defined( SPHERE )
	// A band, so that rolling is seen.
	vec3 onBall = normalize( vLocal );
	float band = smoothstep( 0.34, 0.32, abs( onBall.y ) );
	albedo = mix( albedo, vec3( 0.86, 0.84, 0.80 ), band );
	gloss = 1.0;
	#elif defined( GROUND )
	albedo = vec3( 0.27, 0.275, 0.29 );
	albedo *= 1.0 - 0.20 * gridLine( vWorld.xz, 0.25, 0.002 );
	albedo *= 1.0 - 0.35 * gridLine( vWorld.xz, 1.0, 0.005 );
	gloss = 0.0;
	#endif

	vec3 toEye = uEye - vWorld;
	float distanceToEye = length( toEye );
	toEye /= distanceToEye;
	float facing = dot( normal, uToSun );
	float sun = facing > 0.0 ? facing * sunSeen() : 0.0;
	float open = 0.35 + 0.65 * skySeen();
	vec3 around = mix( kGroundLight, kSkyLight, normal.y * 0.5 + 0.5 ) * open;
	vec3 light = albedo * ( around + kSun * sun );

	#if !defined( GROUND )
	vec3 halfway = normalize( toEye + uToSun );
	float fresnel = 0.04 + 0.96 * pow( 1.0 - max( dot( normal, toEye ), 0.0 ), 5.0 );
	light += kSun * sun * gloss * 0.35 * pow( max( dot( normal, halfway ), 0.0 ), 60.0 );
	light += gloss * 0.45 * fresnel * open * skyColour( reflect( -toEye, normal ) );
	#endif

	float fog = 1.0 - exp( -pow( distanceToEye / uFogDistance, 2.0 ) );
	light = mix( light, skyColour( vec3( -toEye.x, 0.0, -toEye.z ) ), fog );
	outColour = vec4( display( light ), 1.0 );
#endif
}
)";

} // namespace pliant_glue
