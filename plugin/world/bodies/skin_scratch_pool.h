#pragma once

// Room for the skins that are being made: bodies borrow it from their world in turn. Where each had its own it was out of the cache
// whenever its turn came, at a twentieth of what skins cost, and of three times what is drawn.

#include "surface/skin/skinning.h"

#include <memory>
#include <mutex>
#include <vector>

namespace pliant {

class SkinScratchPool
{
public:
	/// Goes back where it came from at its end.
	class Borrowed
	{
	public:
		/// `from` null: of a body in no world, by itself.
		explicit Borrowed( SkinScratchPool* from ) : m_from( from ), m_scratch( from ? from->take() : std::make_unique<SkinScratch>() ) {}
		~Borrowed()
		{
			if ( m_from )
			{
				m_from->giveBack( std::move( m_scratch ) );
			}
		}
		Borrowed( const Borrowed& ) = delete;
		Borrowed& operator=( const Borrowed& ) = delete;
		SkinScratch& operator*() const { return *m_scratch; }

	private:
		SkinScratchPool* m_from;
		std::unique_ptr<SkinScratch> m_scratch;
	};

private:
	/// The one that was given back last, which is warmest.
	std::unique_ptr<SkinScratch> take()
	{
		const std::lock_guard lock( m_lock );
		if ( m_free.empty() )
		{
			m_free.reserve( ++m_made ); // what is given back finds its place there
			return std::make_unique<SkinScratch>();
		}
		std::unique_ptr<SkinScratch> scratch = std::move( m_free.back() );
		m_free.pop_back();
		return scratch;
	}
	void giveBack( std::unique_ptr<SkinScratch> scratch )
	{
		const std::lock_guard lock( m_lock );
		m_free.push_back( std::move( scratch ) );
	}

	std::mutex m_lock;
	std::size_t m_made = 0;
	std::vector<std::unique_ptr<SkinScratch>> m_free; ///< as many as threads at a time made skins
};

} // namespace pliant
