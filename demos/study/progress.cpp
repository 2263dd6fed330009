// +-----------------------------------------------------------------------------------------------------------------+
// | A line redrawn on a terminal, a line every tenth in a log.                                                       |
// +-----------------------------------------------------------------------------------------------------------------+

#include "demos/study/progress.h"

#include "demos/progress_line.h"

#include <csignal>
#include <cstdio>

namespace pliant_study {

namespace {

constexpr int kBarWidth = 30;
volatile std::sig_atomic_t g_stop = 0; // set by the signal, read by the loop: a handler may do no more

void askForStop( int signal )
{
	g_stop = 1;
	std::signal( signal, SIG_DFL );
}

std::string clock( double seconds )
{
	char text[32];
	const int all = int( seconds + 0.5 );
	std::snprintf( text, sizeof( text ), "%d:%02d:%02d", all / 3600, all / 60 % 60, all % 60 );
	return text;
}

} // namespace

void listenForStop()
{
	std::signal( SIGINT, askForStop );
	std::signal( SIGTERM, askForStop );
}

bool stopWasAsked()
{
	return g_stop != 0;
}

Progress::Progress( int total ) :
	m_total( total ), m_isTerminal( pliant_demos::standardOutputIsTerminal() ), m_start( std::chrono::steady_clock::now() )
{}

Progress::~Progress()
{
	if ( m_isTerminal && m_total > 0 )
	{
		std::printf( "\n" );
	}
}

void Progress::begin( const std::string& what )
{
	m_what = what;
	if ( m_isTerminal )
	{
		show();
	}
}

void Progress::done()
{
	++m_done;
	const int tenth = m_done * 10 / m_total;
	if ( m_isTerminal || tenth > m_lastTenth )
	{
		show();
	}
	m_lastTenth = tenth;
}

void Progress::show()
{
	const double spent = std::chrono::duration<double>( std::chrono::steady_clock::now() - m_start ).count();
	const std::string left = m_done > 0 ? clock( spent / m_done * ( m_total - m_done ) ) + " left" : "";
	if ( m_isTerminal )
	{
		const int filled = m_done * kBarWidth / m_total;
		const std::string bar = std::string( std::size_t( filled ), '#' ) + std::string( std::size_t( kBarWidth - filled ), '.' );
		std::printf( "\r[%s] %d of %d, %s  %-60.60s", bar.c_str(), m_done, m_total, left.c_str(), m_what.c_str() );
	}
	else
	{
		std::printf( "%d of %d runs, %s\n", m_done, m_total, left.c_str() );
	}
	std::fflush( stdout );
}

} // namespace pliant_study
