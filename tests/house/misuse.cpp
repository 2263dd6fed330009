// Every public call that takes an argument has a test of its misuse: in a file named *misuse_test.cpp, under the quoted name of the call.

#include "house/source_tree.h"

#include <algorithm>
#include <cctype>
#include <regex>

namespace house {

namespace {

/// Calls that cannot be misused, or whose misuse the library cannot detect, and the reason.
struct Exempt
{
	std::regex name;
	const char* reason;
};

const std::vector<Exempt>& exemptCalls()
{
	static const std::vector<Exempt> kCalls = {
		{ std::regex( R"(BytesView::BytesView|Result::(success|failure))" ), "makes a value; calls that take it look at it" },
		{ std::regex( R"((ForceField|Wind|Water|Planet)::(actsOn|acceleration|surfaceForce|volumeForce|velocityAt))" ),
			"is what the library calls, with what it has measured" },
		{ std::regex( R"(SoftBodyWorldOver::(addSoftBody|removeSoftBody))" ), "passes on to SoftBodyHost's, or to Bullet's own" },
		{ std::regex( R"(SoftBodyWorld(Over)?::SoftBodyWorld(Over)?|SoftBodyWorldOver::(debugDrawObject|serialize|solveConstraints))" ),
			"is Bullet's own, which takes no null either" },
		{ std::regex( R"(VehicleRaycaster::(VehicleRaycaster|debugDraw))" ), "takes any group and mask; draws nothing" },
		{ std::regex( R"(saveTemplate)" ), "takes any template" },
	};
	return kCalls;
}

/// A header without comments, preprocessor lines and parts marked as internal.
std::string declarationsOf( const SourceFile& header )
{
	std::string text;
	bool isInternal = false;
	for ( const std::string& line : header.lines )
	{
		isInternal = isInternal || line.find( "@cond INTERNAL" ) != std::string::npos;
		if ( !isInternal && !line.starts_with( '#' ) )
		{
			text += line.substr( 0, line.find( "//" ) ) + " ";
		}
		isInternal = isInternal && line.find( "@endcond" ) == std::string::npos;
	}
	return text;
}

std::string trimmed( const std::string& text )
{
	const std::size_t first = text.find_first_not_of( " \t" );
	return first == std::string::npos ? "" : text.substr( first, text.find_last_not_of( " \t" ) - first + 1 );
}

/// Returns the parameters of a function's declaration, and its name in `name`; "" for other declarations and functions without parameters.
std::string parametersOf( const std::string& statement, std::string& name )
{
	static const std::regex kOther( R"(^\s*(using|typedef|friend|static_assert|enum)\b|=\s*(delete|default)\s*$)" );
	static const std::regex kHead( R"(^([^=(]*?)(~?\w+)\s*\()" );
	std::smatch head;
	if ( std::regex_search( statement, kOther ) || !std::regex_search( statement, head, kHead ) )
	{
		return "";
	}
	name = head[2];
	const std::size_t first = std::size_t( head.length() );
	std::size_t last = first;
	for ( int depth = 1; last < statement.size(); ++last )
	{
		depth += statement[last] == '(' ? 1 : statement[last] == ')' ? -1 : 0;
		if ( depth == 0 )
		{
			break;
		}
	}
	const std::string parameters = trimmed( statement.substr( first, last - first ) );
	return parameters.starts_with( '*' ) ? "" : parameters; // a pointer to a function
}

/// Reads declarations from the outside in: namespaces, and types with their access.
class CallReader
{
public:
	std::map<std::string, int> read( const std::string& text )
	{
		int depth = 0; // of parentheses
		for ( const char c : text )
		{
			depth += c == '(' ? 1 : c == ')' ? -1 : 0;
			if ( depth > 0 || !( c == '{' || c == '}' || c == ';' || c == ':' ) )
			{
				m_statement += c;
			}
			else if ( c == '{' )
			{
				open();
			}
			else if ( c == '}' )
			{
				m_scopes.empty() ? void() : m_scopes.pop_back();
				m_statement.clear();
			}
			else
			{
				c == ';' ? end() : changeAccess();
			}
		}
		return m_calls;
	}

private:
	struct Scope
	{
		std::string name;
		bool isOpen = true; ///< public
	};

	void open()
	{
		static const std::regex kType( R"(^\s*(?:template\s*<.*>\s*)?(class|struct)\s+(?:\[\[\w+\]\]\s+)?(?:PLIANT_API\s+)?(\w+))" );
		static const std::regex kNamespace( R"(^\s*namespace\b)" );
		std::smatch type;
		if ( std::regex_search( m_statement, type, kType ) )
		{
			m_scopes.push_back( Scope{ type[2], type[1] == "struct" && isOpen() } );
		}
		else
		{
			const bool isNamespace = std::regex_search( m_statement, kNamespace );
			end();
			m_scopes.push_back( Scope{ "", isNamespace && isOpen() } );
		}
		m_statement.clear();
	}

	bool isOpen() const
	{
		return std::ranges::all_of( m_scopes, []( const Scope& scope ) { return scope.isOpen; } );
	}

	void changeAccess()
	{
		static const std::regex kAccess( R"(^\s*(public|protected|private)\s*$)" );
		std::smatch access;
		if ( !m_scopes.empty() && std::regex_match( m_statement, access, kAccess ) )
		{
			m_scopes.back().isOpen = access[1] == "public";
			m_statement.clear();
			return;
		}
		m_statement += ':';
	}

	void end()
	{
		static const std::regex kTemplate( R"(^\s*template\s*<[^()]*?>\s*(?=\S))" );
		static const std::regex kBools( R"(^bool \w+$)" ); // either value is valid
		const std::string statement = std::regex_replace( m_statement, kTemplate, "" );
		m_statement.clear();
		std::string name;
		const std::string parameters = isOpen() ? parametersOf( statement, name ) : "";
		if ( !parameters.empty() && !std::regex_match( parameters, kBools ) )
		{
			std::string whole;
			for ( const Scope& scope : m_scopes )
			{
				whole += scope.name.empty() ? "" : scope.name + "::";
			}
			++m_calls[whole + name];
		}
	}

	std::vector<Scope> m_scopes;
	std::string m_statement;
	std::map<std::string, int> m_calls; ///< overloads by name
};

} // namespace

std::map<std::string, int> publicCalls( const SourceTree& tree )
{
	std::map<std::string, int> all;
	for ( const auto& [path, file] : tree.files() )
	{
		if ( path.starts_with( "plugin/include/" ) )
		{
			for ( const auto& [name, overloads] : CallReader().read( declarationsOf( file ) ) )
			{
				all[name] += overloads;
			}
		}
	}
	return all;
}

Complaints checkMisuse( const SourceTree& tree )
{
	static const std::regex kLabel( R"rx("((?:\w+::)*\w+)")rx" );
	std::map<std::string, int> tested;
	for ( const auto& [path, file] : tree.files() )
	{
		if ( !path.starts_with( "tests/" ) || !path.ends_with( "misuse_test.cpp" ) )
		{
			continue;
		}
		std::string text;
		for ( const std::string& line : file.lines )
		{
			text += line + "\n";
		}
		for ( std::sregex_iterator label( text.begin(), text.end(), kLabel ), none; label != none; )
		{
			const std::smatch match = *label++;
			const std::string name = match[1], called = name.substr( name.rfind( ':' ) + 1 );
			const std::size_t first = std::size_t( match.position() + match.length() );
			const std::size_t last = label == none ? text.size() : std::size_t( label->position() );
			const std::regex call( "\\b" + called + "\\b" );
			tested[name] += std::regex_search( text.begin() + std::ptrdiff_t( first ), text.begin() + std::ptrdiff_t( last ), call ) ? 1
																																	 : 0;
		}
	}
	Complaints complaints;
	for ( const auto& [name, overloads] : publicCalls( tree ) )
	{
		const bool isExempt = std::ranges::any_of(
			exemptCalls(), [&call = name]( const Exempt& exempt ) { return std::regex_match( call, exempt.name ); } );
		if ( !isExempt && tested[name] < overloads )
		{
			complaints.push_back( name + ": " + std::to_string( overloads ) + " overload(s), " + std::to_string( tested[name] ) +
				" tested for misuse in a *misuse_test.cpp" );
		}
	}
	return complaints;
}

} // namespace house
