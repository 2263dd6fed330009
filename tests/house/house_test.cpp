// The rules of the repository, applied to it; and to small broken source trees, in which each rule has to report its breach.

#include "house/source_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

namespace house {

namespace {

namespace fs = std::filesystem;

std::string listOf( const Complaints& complaints )
{
	std::string list;
	for ( const std::string& complaint : complaints )
	{
		list += "\n  " + complaint;
	}
	return list;
}

const SourceTree& ours()
{
	static const SourceTree kTree{ fs::path( PLIANT_ROOT ) };
	return kTree;
}

// A source tree of a few files in a folder of its own.
class SmallHouse : public testing::Test
{
protected:
	SmallHouse()
	{
		const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
		m_root = fs::path( testing::TempDir() ) / ( std::string( "pliant_house_" ) + test->name() );
		fs::remove_all( m_root );
		fs::create_directories( m_root );
	}

	~SmallHouse() override { fs::remove_all( m_root ); }

	void put( const std::string& path, const std::string& text )
	{
		fs::create_directories( ( m_root / path ).parent_path() );
		std::ofstream( m_root / path ) << text;
	}

	SourceTree tree() const { return SourceTree( m_root ); }

	fs::path m_root;
};

std::string repeated( const std::string& line, int count )
{
	std::string text;
	for ( int i = 0; i < count; ++i )
	{
		text += line;
	}
	return text;
}

// --- the repository -----------------------------------------------------------------------------------------------------

TEST( House, IsReadAtAll )
{
	ASSERT_GT( ours().files().size(), 60u );
	const SourceFile& body = ours().files().at( "plugin/body/body.cpp" );
	const bool resolves = std::ranges::any_of(
		body.includes, []( const Include& include ) { return include.resolved == "plugin/body/body.h"; } );
	EXPECT_TRUE( resolves );
}

TEST( House, ArrowsRunDownTheFloors )
{
	const Complaints complaints = checkFloors( ours() );
	EXPECT_TRUE( complaints.empty() ) << listOf( complaints );
}

TEST( House, HeadersIncludeLowerSubfoldersOnly )
{
	const Complaints complaints = checkSubfolders( ours() );
	EXPECT_TRUE( complaints.empty() ) << listOf( complaints );
}

TEST( House, StagesAreCalledInOnePlace )
{
	const Complaints complaints = checkStages( ours() );
	EXPECT_TRUE( complaints.empty() ) << listOf( complaints );
}

TEST( House, StagesAreCalledInOrder )
{
	const Complaints complaints = checkStageOrder( ours() );
	EXPECT_TRUE( complaints.empty() ) << listOf( complaints );
}

TEST( House, HasNoCircles )
{
	const Complaints complaints = checkCircles( ours() );
	EXPECT_TRUE( complaints.empty() ) << listOf( complaints );
}

TEST( House, CoreReachesNoBulletAndPublicHeadersNoEigen )
{
	const Complaints complaints = checkReach( ours() );
	EXPECT_TRUE( complaints.empty() ) << listOf( complaints );
}

TEST( House, FilesAndFunctionsAreShort )
{
	const Complaints complaints = checkShape( ours() );
	EXPECT_TRUE( complaints.empty() ) << listOf( complaints );
}

TEST( House, ConstantsHaveNamesOfTheirOwn )
{
	const Complaints complaints = checkConstants( ours() );
	EXPECT_TRUE( complaints.empty() ) << listOf( complaints );
}

TEST( House, NumbersAreInFilesOfConstants )
{
	const Complaints complaints = checkNumbers( ours() );
	EXPECT_TRUE( complaints.empty() ) << listOf( complaints );
}

TEST( House, TopLevelHoldsWhatBelongsThere )
{
	const Complaints complaints = checkTopLevel( PLIANT_ROOT );
	EXPECT_TRUE( complaints.empty() ) << listOf( complaints );
}

TEST( House, DocumentsNameWhatIsThere )
{
	const Complaints complaints = checkDocuments( ours() );
	EXPECT_TRUE( complaints.empty() ) << listOf( complaints );
}

TEST( House, HasOneVersion )
{
	const Complaints complaints = checkVersion( PLIANT_ROOT );
	EXPECT_TRUE( complaints.empty() ) << listOf( complaints );
}

TEST( House, EveryPublicCallHasATestOfItsMisuse )
{
	EXPECT_GT( publicCalls( ours() ).size(), 100u );
	const Complaints complaints = checkMisuse( ours() );
	EXPECT_TRUE( complaints.empty() ) << listOf( complaints );
}

// --- broken houses ------------------------------------------------------------------------------------------------------

struct Breach
{
	const char* name;
	const char* path;
	const char* include;
	bool allowed;
};

class FloorBreach : public SmallHouse, public testing::WithParamInterface<Breach>
{};

TEST_P( FloorBreach, IsSeen )
{
	for ( const char* path : { "plugin/include/pliant/mesh.h", "plugin/lattice/lattice.h", "plugin/threads/pool.h",
			  "plugin/matching/matcher.h", "plugin/surface/skinning.h", "plugin/body/body.h", "plugin/world/node_shape.h",
			  "plugin/c/handles.h", "third_party_glue/window.h", "tests/support/block.h" } )
	{
		put( path, "#pragma once\n" );
	}
	put( GetParam().path, std::string( "#include " ) + GetParam().include + "\n" );
	EXPECT_EQ( checkFloors( tree() ).empty(), GetParam().allowed ) << listOf( checkFloors( tree() ) );
}

const Breach kBreaches[] = {
	{ "MatchingMayUseLattice", "plugin/matching/a.cpp", "\"lattice/lattice.h\"", true },
	{ "LatticeMayUseFaceAndEigen", "plugin/lattice/a.cpp", "\"pliant/mesh.h\"\n#include <Eigen/Core>\n#include <vector>", true },
	{ "WorldMayUseBullet", "plugin/world/a.cpp", "<BulletDynamics/Dynamics/btRigidBody.h>", true },
	{ "DemosMayUseGlueAndFace", "demos/a.cpp", "\"third_party_glue/window.h\"\n#include <pliant/mesh.h>", true },
	{ "TestsMayLookInside", "tests/body/a.cpp", "\"body/body.h\"", true },
	{ "LatticeUsesMatching", "plugin/lattice/a.cpp", "\"matching/matcher.h\"", false },
	{ "ThreadsUseLattice", "plugin/threads/a.cpp", "\"lattice/lattice.h\"", false },
	{ "SurfaceUsesBody", "plugin/surface/a.cpp", "\"../body/body.h\"", false },
	{ "BodyUsesWorld", "plugin/body/a.cpp", "\"world/node_shape.h\"", false },
	{ "FaceUsesLattice", "plugin/include/pliant/a.h", "\"lattice/lattice.h\"", false },
	{ "FaceUsesEigen", "plugin/include/pliant/a.h", "<Eigen/Core>", false },
	{ "CoreUsesBullet", "plugin/matching/a.cpp", "<LinearMath/btVector3.h>", false },
	{ "CoreUsesBulletAll", "plugin/body/a.cpp", "<btBulletDynamicsCommon.h>", false },
	{ "CoreUsesAssimp", "plugin/lattice/a.cpp", "<assimp/scene.h>", false },
	{ "PluginUsesGlue", "plugin/world/a.cpp", "\"third_party_glue/window.h\"", false },
	{ "PluginUsesTests", "plugin/body/a.cpp", "\"support/block.h\"", false },
	{ "CFaceMayUseIntegers", "plugin/include/pliant/c/a.h", "<stdint.h>", true },
	{ "CFaceUsesCpp", "plugin/include/pliant/c/a.h", "\"pliant/mesh.h\"", false },
	{ "CFaceUsesStandardCpp", "plugin/include/pliant/c/a.h", "<vector>", false },
	{ "FaceUsesCOfItself", "plugin/include/pliant/a.h", "<stdint.h>", false },
	{ "WorldUsesC", "plugin/world/a.cpp", "\"c/handles.h\"", false },
	{ "CMayUseWorld", "plugin/c/a.cpp", "\"world/node_shape.h\"", true },
	{ "FolderWithoutFloor", "plugin/attic/a.cpp", "<vector>", false },
	{ "GlueUsesFace", "third_party_glue/a.cpp", "<pliant/mesh.h>", false },
	{ "GlueUsesPlugin", "third_party_glue/a.cpp", "\"plugin/body/body.h\"", false },
	{ "DemosLookInside", "demos/a.cpp", "\"plugin/body/body.h\"", false },
	{ "DemosUseTests", "demos/a.cpp", "\"tests/support/block.h\"", false },
};

INSTANTIATE_TEST_SUITE_P( House, FloorBreach, testing::ValuesIn( kBreaches ), []( const auto& breach ) { return breach.param.name; } );

TEST_F( SmallHouse, WrongSubfoldersAreSeen )
{
	put( "plugin/world/shape/a.h", "#pragma once\n#include \"world/constants.h\"\n" );
	put( "plugin/world/constants.h", "#pragma once\n" );
	put( "plugin/world/step/b.h", "#pragma once\n#include \"world/shape/a.h\"\n" );
	put( "plugin/world/shape/a.cpp", "#include \"world/step/b.h\"\n" );
	EXPECT_TRUE( checkSubfolders( tree() ).empty() ) << listOf( checkSubfolders( tree() ) );

	put( "plugin/world/touch/c.h", "#pragma once\n#include \"world/step/b.h\"\n" );
	put( "plugin/world/attic/d.cpp", "int d;\n" );
	for ( int i = 0; i < 21; ++i )
	{
		put( "plugin/threads/e" + std::to_string( i ) + ".cpp", "int e;\n" );
	}
	EXPECT_EQ( checkSubfolders( tree() ).size(), 3u ) << listOf( checkSubfolders( tree() ) );
}

TEST_F( SmallHouse, StagesCalledElsewhereAreSeen )
{
	std::string order;
	for ( const std::string& line : ours().files().at( "plugin/world/step/world_step.cpp" ).lines )
	{
		order += line + "\n";
	}
	put( "plugin/world/step/world_step.cpp", order );
	EXPECT_TRUE( checkStages( tree() ).empty() ) << listOf( checkStages( tree() ) );
	put( "plugin/world/api/a.cpp", "void a() { bodies.wakeTouched(); }\n" );
	EXPECT_EQ( checkStages( tree() ).size(), 1u );
	put( "plugin/world/step/world_step.cpp", "" );
	EXPECT_GT( checkStages( tree() ).size(), 20u );
}

TEST_F( SmallHouse, StagesOutOfOrderAreSeen )
{
	std::string order;
	for ( const std::string& line : ours().files().at( "plugin/world/step/world_step.cpp" ).lines )
	{
		const bool isDetect = line.find( "m_stages.detect()" ) != std::string::npos;
		const bool isIslands = line.find( "m_stages.findIslands()" ) != std::string::npos;
		order += ( isDetect ? "	m_stages.findIslands();" : isIslands ? "	m_stages.detect();" : line ) + "\n";
	}
	put( "plugin/world/step/world_step.cpp", order );
	EXPECT_EQ( checkStageOrder( tree() ).size(), 1u ) << listOf( checkStageOrder( tree() ) );
}

TEST_F( SmallHouse, CircleIsSeen )
{
	put( "plugin/body/a.h", "#include \"body/b.h\"\n" );
	put( "plugin/body/b.h", "#include \"c.h\"\n" );
	put( "plugin/body/c.h", "#include <vector>\n" );
	EXPECT_TRUE( checkCircles( tree() ).empty() );
	put( "plugin/body/c.h", "#include \"a.h\"\n" );
	EXPECT_EQ( checkCircles( tree() ).size(), 1u );
}

TEST_F( SmallHouse, BulletReachedThroughAFaceIsSeen )
{
	put( "plugin/include/pliant/soft_body.h", "#include <LinearMath/btVector3.h>\n" );
	put( "plugin/lattice/lattice.h", "#include \"pliant/soft_body.h\"\n" );
	const Complaints complaints = checkReach( tree() );
	ASSERT_EQ( complaints.size(), 1u );
	EXPECT_NE( complaints[0].find( "btVector3" ), std::string::npos );
}

TEST_F( SmallHouse, EigenReachedFromAFaceIsSeen )
{
	put( "plugin/lattice/lattice.h", "#include <Eigen/Core>\n" );
	put( "plugin/include/pliant/mesh.h", "#include \"lattice/lattice.h\"\n" );
	EXPECT_EQ( checkReach( tree() ).size(), 1u );
}

TEST_F( SmallHouse, LengthIsSeen )
{
	put( "plugin/body/a.cpp", repeated( "int a();\n", 420 ) );
	put( "plugin/body/b.cpp", "void b()\n{\n" + repeated( "\ta();\n", 60 ) + "}\n" );
	put( "plugin/body/c.cpp", "class C\n{\npublic:\n\tvoid c() const\n\t{\n" + repeated( "\t\ta();\n", 60 ) + "\t}\n};\n" );
	put( "plugin/body/d.cpp",
		"namespace d\n{\n" + repeated( "int a();\n", 90 ) + "}\nconst int kNumbers[] =\n{\n" + repeated( "\t1,\n", 90 ) + "};\n" );
	EXPECT_TRUE( checkShape( tree() ).empty() ) << listOf( checkShape( tree() ) );

	put( "plugin/body/a.cpp", repeated( "int a();\n", 421 ) );
	put( "plugin/body/b.cpp", "void b(\n\tint x )\n{\n" + repeated( "\ta();\n", 61 ) + "}\n" );
	put( "plugin/body/c.cpp", "class C\n{\npublic:\n\tvoid c() const\n\t{\n" + repeated( "\t\ta();\n", 61 ) + "\t}\n};\n" );
	EXPECT_EQ( checkShape( tree() ).size(), 3u ) << listOf( checkShape( tree() ) );
}

TEST_F( SmallHouse, WidthIsSeen )
{
	put( "plugin/body/a.cpp",
		"\t// " + std::string( 133, 'a' ) + "\n// clang-format off\n" + std::string( 141, 'b' ) + "\n// clang-format on\n" );
	EXPECT_TRUE( checkShape( tree() ).empty() ) << listOf( checkShape( tree() ) );
	put( "plugin/body/a.cpp", "\t// " + std::string( 134, 'a' ) + "\n" );
	EXPECT_EQ( checkShape( tree() ).size(), 1u );
}

TEST_F( SmallHouse, UnwantedWordsAreSeen )
{
	put( "plugin/body/a.cpp",
		"int a = operand( 1 ); // rand() is not used, nor throw\nvoid b() { throw; }\nbool c = gContactAddedCallback == nullptr;\n" );
	put( "plugin/body/a.h", "#pragma once\n" );
	EXPECT_TRUE( checkShape( tree() ).empty() ) << listOf( checkShape( tree() ) );

	put( "plugin/body/a.cpp",
		"int a = rand();\nvoid b() { throw 1; }\nauto* c = dynamic_cast<C*>( d );\nint e = std::printf( \"e\" );\ngContactAddedCallback = "
		"f;\n" );
	put( "plugin/body/a.h", "using namespace std;\n" );
	EXPECT_EQ( checkShape( tree() ).size(), 7u ) << listOf( checkShape( tree() ) );
}

TEST_F( SmallHouse, ConstantsOfOneNameAreSeen )
{
	put( "plugin/body/a.h", "inline constexpr int kLanes = 16;\nstruct A\n{\n\tstatic constexpr int kCount = 1;\n};\n" );
	put( "plugin/body/a.cpp", "constexpr int kLanes = 2;\n" );
	put( "plugin/world/b.h", "inline constexpr int kMoreLanes = 4;\nstruct B\n{\n\tstatic constexpr int kCount = 2;\n};\n" );
	EXPECT_TRUE( checkConstants( tree() ).empty() ) << listOf( checkConstants( tree() ) );
	put( "plugin/world/b.h", "inline constexpr int kLanes = 4;\n" );
	EXPECT_EQ( checkConstants( tree() ).size(), 1u );
}

TEST_F( SmallHouse, NumbersOutsideOfFilesOfConstantsAreSeen )
{
	put( "plugin/body/body_constants.h", "inline constexpr int kA = 3;\n" );
	put( "plugin/matching/kernels/b.h", "constexpr float kB = 1e-6f;\n" );
	put( "plugin/body/a.cpp",
		"constexpr std::uint32_t kNone = ~0u, kAll = 0xffffffffu;\nconstexpr int kC = kA;\nconstexpr int kD[2] = { 1, 2 };\n"
		"const double E::kE = 1.5;\nvoid f()\n{\n\tconstexpr int kF = 2;\n}\n" );
	EXPECT_TRUE( checkNumbers( tree() ).empty() ) << listOf( checkNumbers( tree() ) );
	put( "plugin/body/a.h", "inline constexpr double kG = .5; // m\n" );
	put( "plugin/body/a.cpp", "constexpr float kH = 0.0f, kI =\n\t1e-6f;\nconst btScalar kJ( 2 );\nstatic constexpr auto kK{ 0x10 };\n" );
	put( "plugin/matching/raised_inverse.cpp", "" ); // without its exception
	EXPECT_EQ( checkNumbers( tree() ).size(), 6u ) << listOf( checkNumbers( tree() ) );
}

TEST_F( SmallHouse, CallsWithoutATestOfTheirMisuseAreSeen )
{
	put( "plugin/include/pliant/a.h",
		"/// f( 1 ) is no call.\nnamespace pliant {\nstruct Settings\n{\n\tint a = int( 1 );\n\tfloat ( *paint )( int ) = nullptr;\n};\n"
		"class PLIANT_API Body\n{\npublic:\n\tBody( const Body& ) = delete;\n\tvirtual ~Body();\n\tint count() const;\n"
		"\tvoid setOn( bool isOn );\n\t/// @cond INTERNAL\n\tvoid internal( int );\n\t/// @endcond\nprotected:\n\tvoid own( int );\n"
		"private:\n\tint m_a = int( 2 );\n};\n}\n" );
	EXPECT_TRUE( publicCalls( tree() ).empty() );
	const std::map<std::string, int> calls = { { "Body::Body", 1 }, { "Body::push", 2 }, { "Box::Corner::move", 1 }, { "check", 1 } };
	put( "plugin/include/pliant/game/b.h",
		"namespace pliant {\nclass PLIANT_API Body : public Base\n{\npublic:\n\texplicit Body( int size = int( 1 ) ) : m_size( size ) {}\n"
		"\t[[nodiscard]] Status push( const Vector& force,\n\t\tint node = 0 ); ///< N\n\tvoid push( const Settings& settings = {} );\n};\n"
		"template <class T>\nstruct [[nodiscard]] Box\n{\n\tstruct Corner\n\t{\n\t\ttemplate <class A>\n\t\tauto move( A* by ) -> "
		"decltype( by->f() )\n"
		"\t\t{\n\t\t\tg( by );\n\t\t}\n\t};\n};\nPLIANT_API Status check( const Settings& settings );\n}\n" );
	EXPECT_EQ( publicCalls( tree() ), calls );
	EXPECT_EQ( checkMisuse( tree() ).size(), 4u );
	put( "tests/a_misuse_test.cpp",
		"{ \"Body::Body\", Body( -1 ) }, { \"Body::push\", push( nan ), \"x\" }, { \"Box::Corner::move\", move( 0 ) }" );
	put( "tests/b_misuse_test.cpp", "{ \"check\", nothing( -1 ) }, { \"Body::push\", push( 1, -1 ) }" );
	put( "tests/c_test.cpp", "{ \"check\", check( bad ) }" );
	const Complaints complaints = checkMisuse( tree() );
	ASSERT_EQ( complaints.size(), 1u ) << listOf( complaints );
	EXPECT_TRUE( complaints[0].starts_with( "check: " ) ) << complaints[0];
}

TEST_F( SmallHouse, TopLevelIsSeen )
{
	for ( const char* name : { "CMakeLists.txt", "README.md", "LICENSE", "CHANGELOG.md", "CONTRIBUTING.md", "CMakePresets.json",
			  "vcpkg.json", ".gitignore", "plugin/a", "demos/a", "third_party_glue/a", "tests/a", "docs/a", "build/a", "out/a" } )
	{
		put( name, "" );
	}
	EXPECT_TRUE( checkTopLevel( m_root ).empty() ) << listOf( checkTopLevel( m_root ) );
	put( "scripts/a", "" );
	fs::remove( m_root / "LICENSE" );
	EXPECT_EQ( checkTopLevel( m_root ).size(), 2u );
}

TEST_F( SmallHouse, WrongNamesInDocumentsAreSeen )
{
	put( "plugin/body/a.cpp", "" );
	put( "tests/body/a_test.cpp", "TEST( Body, Falls )\nTEST_P( Cube, Rests )\nINSTANTIATE_TEST_SUITE_P( All, Cube, values );\n" );
	put( "docs/design/b.md", "" );
	put( "docs/guide/c.md",
		"[b](../design/b.md#part), `body/a.cpp`, `a.cpp` `f`, `./plugin/body/`, `g/*.cpp`, `out/`, `Body.Falls`, `Cube.*`\n"
		"`body_test --gtest_filter=Body.*:*Cube.Rests/Small*`\n```\n`none.cpp`\n```\n" );
	EXPECT_TRUE( checkDocuments( tree() ).empty() ) << listOf( checkDocuments( tree() ) );
	put( "README.md",
		"[d](docs/d.md) `world/a.cpp` `plugin/world/` `body_test --gtest_filter='Body.*:Cube.*'` `Body.Flies`\n```\nworld/a.cpp\n```\n" );
	EXPECT_EQ( checkDocuments( tree() ).size(), 6u ) << listOf( checkDocuments( tree() ) );
}

TEST_F( SmallHouse, VersionsAreSeen )
{
	put( "plugin/include/pliant/version.h",
		"#define PLIANT_VERSION_MAJOR 1\n#define PLIANT_VERSION_MINOR 2\n#define PLIANT_VERSION_PATCH 3\n" );
	put( "vcpkg.json", "{ \"version\": \"1.2.3\" }\n" );
	put( "CHANGELOG.md", "# Changes\n\n## 1.2.3\n\n## 1.2.2\n" );
	EXPECT_TRUE( checkVersion( m_root ).empty() ) << listOf( checkVersion( m_root ) );
	put( "vcpkg.json", "{ \"version\": \"1.2.2\" }\n" );
	put( "CHANGELOG.md", "# Changes\n\n## 1.2.4\n\n## 1.2.3\n" );
	EXPECT_EQ( checkVersion( m_root ).size(), 2u );
}

} // namespace

} // namespace house
