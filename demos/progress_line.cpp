// +-----------------------------------------------------------------------------------------------------------------+
// | A bar of text on standard output.                                                                                |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/progress_line.h"

#include <cstdio>
#include <utility>

#if defined( _WIN32 )
	#include <io.h>
#else
	#include <unistd.h>
#endif

namespace pliant_demos {

namespace {

constexpr int kBarWidth = 40;

} // namespace

bool standardOutputIsTerminal()
{
#if defined( _WIN32 )
	return _isatty( _fileno( stdout ) ) != 0;
#else
	return isatty( STDOUT_FILENO ) != 0;
#endif
}

ProgressLine::ProgressLine( std::string name, int total ) :
	m_name( std::move( name ) ), m_total( total ), m_isTerminal( standardOutputIsTerminal() )
{}

void ProgressLine::show( int done )
{
	const int tenth = done * 10 / m_total;
	if ( m_isTerminal )
	{
		const int filled = done * kBarWidth / m_total;
		const std::string bar = std::string( std::size_t( filled ), '#' ) + std::string( std::size_t( kBarWidth - filled ), '.' );
		std::printf( "\r  %s [%s] frame %d of %d", m_name.c_str(), bar.c_str(), done, m_total );
	}
	else if ( tenth > m_lastTenth )
	{
		std::printf( "  %s: frame %d of %d\n", m_name.c_str(), done, m_total );
	}
	m_lastTenth = tenth;
	std::fflush( stdout );
}

void ProgressLine::end()
{
	if ( m_isTerminal )
	{
		std::printf( "\n" );
	}
}

} // namespace pliant_demos
