#pragma once

// Writes state to bytes, or reads it back, by one description that names each field once: a function `void archive( Archive& )` of the
// structure, or a free function `void archive( Archive&, Structure& )`. What is written is therefore also read.
//
// Numbers are stored as they are in memory (little-endian, IEEE 754), without padding: equal states have equal bytes. Bad data throws
// nothing: the first problem is kept, and everything read after it keeps its value.

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

namespace pliant {

static_assert( std::endian::native == std::endian::little, "Snapshots are little-endian: swap the bytes of numbers in Archive::raw" );

class Archive;

/// Whether every pattern of a type's bytes is a value, and a value has no other bytes.
template <class T>
struct IsFlat : std::bool_constant<std::is_arithmetic_v<T> && !std::is_same_v<T, bool>>
{};
template <class S, int Rows, int Columns, int Options, int MostRows, int MostColumns>
struct IsFlat<Eigen::Matrix<S, Rows, Columns, Options, MostRows, MostColumns>>
	: std::bool_constant<IsFlat<S>::value && ( Rows > 0 ) && ( Columns > 0 ) &&
		  sizeof( Eigen::Matrix<S, Rows, Columns, Options> ) == sizeof( S ) * std::size_t( Rows ) * std::size_t( Columns )>
{};
template <class T, std::size_t N>
struct IsFlat<std::array<T, N>> : std::bool_constant<IsFlat<T>::value && sizeof( std::array<T, N> ) == N * sizeof( T )>
{};

template <class T>
concept HasArchive = requires( T& value, Archive& archive )
{
	value.archive( archive );
};

class Archive
{
public:
	/// Overwrites `to`, whose memory is reused: a list that is written again each frame is neither filled with zeros nor enlarged. `finish`
	/// removes the old rest of it. Must not be copied while it writes.
	explicit Archive( std::vector<std::byte>& to ) : m_to( &to ), m_at( to.data() ), m_limit( to.data() + to.size() ) {}
	/// Reads.
	Archive( const std::byte* data, std::size_t size ) : m_from( data ), m_end( data + size ) {}

	bool isReading() const { return m_to == nullptr; }
	/// Gives the list that is written the length of what has been written.
	void finish() { m_to->resize( written() ); }
	/// From now on the data counts as unchanged since it was written: values are not checked, counts still are.
	void trust() { m_isTrusted = true; }
	bool isTrusted() const { return m_isTrusted; }
	bool isSound() const { return m_problem == nullptr; }
	/// A sentence on what is wrong; null while all is valid.
	const char* problem() const { return m_problem; }
	/// Keeps the first problem; `sentence` must last.
	void refuse( const char* sentence ) { m_problem = m_problem ? m_problem : sentence; }
	/// Refuses the data if a condition does not hold. Returns isSound().
	bool require( bool holds, const char* sentence )
	{
		if ( isReading() && !holds )
		{
			refuse( sentence );
		}
		return isSound();
	}

	/// Writes or reads values in order.
	template <class... T>
	void operator()( T&... values )
	{
		( value( values ), ... );
	}
	/// Writes a value that is const to its owner.
	template <class T>
	void write( const T& written )
	{
		value( const_cast<T&>( written ) );
	}
	/// An enumeration from 0 to `last`.
	template <class T>
	void choice( T& chosen, T last )
	{
		auto number = std::uint8_t( chosen );
		raw( &number, 1 );
		if ( require( number <= std::uint8_t( last ), "A value of an enumeration is out of range." ) && isReading() )
		{
			chosen = T( number );
		}
	}
	/// The first `count` entries of an array whose length is known: it has been made already.
	template <class T, class A>
	void entries( std::vector<T, A>& array, int count )
	{
		static_assert( IsFlat<T>::value );
		if ( require( array.size() >= std::size_t( count ), "An array has another length than its body." ) && count > 0 )
		{
			raw( array.data(), std::size_t( count ) * sizeof( T ) );
		}
	}
	/// An array that has at least `length` entries, of which the first `count` are stored, or else counts as empty: it is empty, or of
	/// another length and waits to be made again.
	template <class T, class A>
	void entriesOrNone( std::vector<T, A>& array, int count, int length )
	{
		bool isAny = !array.empty() && array.size() >= std::size_t( count );
		value( isAny );
		if ( isReading() )
		{
			isAny = isAny && isSound();
			isAny ? array.resize( std::size_t( length ) ) : array.clear();
		}
		if ( isAny )
		{
			entries( array, count );
		}
	}
	/// An array that has been made with the length that is stored.
	template <class T, class A>
	void sameLength( std::vector<T, A>& array )
	{
		auto count = std::uint64_t( array.size() );
		value( count );
		if ( require( count == array.size(), "An array has another length than its body." ) && count > 0 )
		{
			static_assert( IsFlat<T>::value );
			raw( array.data(), array.size() * sizeof( T ) );
		}
	}
	/// Refuses the data if one of the first `count` numbers is NaN or infinite.
	template <class List>
	void requireFinite( const List& numbers, std::size_t count )
	{
		bool areFinite = true;
		for ( std::size_t k = 0; isReading() && !m_isTrusted && isSound() && k < count; ++k )
		{
			areFinite = areFinite && std::isfinite( numbers[k] );
		}
		require( areFinite, "A number is not finite." );
	}
	/// A pointer that owns, null or not; `make` makes the object that is read into.
	template <class Owner, class Make>
	void owned( Owner& pointer, const Make& make )
	{
		bool isAny = pointer != nullptr;
		value( isAny );
		if ( isReading() && isAny != ( pointer != nullptr ) && isSound() )
		{
			pointer = isAny ? make() : nullptr;
		}
		if ( isAny && isSound() )
		{
			value( *pointer );
		}
	}
	void raw( void* bytes, std::size_t size )
	{
		if ( m_to )
		{
			std::memcpy( extend( size ), bytes, size );
		}
		else if ( const std::byte* const from = take( size ) )
		{
			std::memcpy( bytes, from, size );
		}
	}
	/// Memory of the next `size` bytes that are written, to be filled before the next call.
	std::byte* extend( std::size_t size )
	{
		if ( size > std::size_t( m_limit - m_at ) )
		{
			grow( size );
		}
		std::byte* const first = m_at;
		m_at += size;
		return first;
	}
	/// Passes the next bytes that are read, which stay where they are; null where there are fewer.
	const std::byte* take( std::size_t size );

	/// Bytes that are not read yet.
	std::size_t left() const { return isSound() ? std::size_t( m_end - m_from ) : 0; }
	/// A part preceded by its length: opens one for writing; `close` takes the return value of `open`.
	std::size_t open();
	void close( std::size_t opened );
	/// An archive of the next such part, which is then skipped. `tag` distinguishes the parts of a snapshot.
	Archive part();
	const std::byte* data() const { return m_from; }

private:
	std::size_t written() const { return std::size_t( m_at - m_to->data() ); }
	void grow( std::size_t size );

	template <class T>
	void value( T& v )
	{
		if constexpr ( IsFlat<T>::value )
		{
			raw( &v, sizeof( T ) );
		}
		else if constexpr ( std::is_same_v<T, bool> )
		{
			auto byte = std::uint8_t( v ? 1 : 0 );
			raw( &byte, 1 );
			require( byte <= 1, "A flag is neither 0 nor 1." );
			v = isSound() ? byte != 0 : v;
		}
		else if constexpr ( HasArchive<T> )
		{
			v.archive( *this );
		}
		else
		{
			archive( *this, v );
		}
	}
	template <class T, class A>
	void value( std::vector<T, A>& list )
	{
		auto count = std::uint64_t( list.size() );
		value( count );
		constexpr std::size_t kLeast = IsFlat<T>::value ? sizeof( T ) : 1;
		if ( isReading() )
		{
			if ( !require( count <= left() / kLeast, "A list is longer than the data." ) )
			{
				return;
			}
			list.clear();
		}
		if constexpr ( IsFlat<T>::value )
		{
			list.resize( std::size_t( count ) );
			if ( count > 0 )
			{
				raw( list.data(), std::size_t( count ) * sizeof( T ) );
			}
		}
		else
		{
			for ( std::uint64_t k = 0; k < count && isSound(); ++k )
			{
				if ( isReading() )
				{
					list.emplace_back();
				}
				value( list[std::size_t( k )] );
			}
		}
	}
	template <class S>
	void value( Eigen::Quaternion<S>& q )
	{
		raw( q.coeffs().data(), 4 * sizeof( S ) );
	}
	template <class T, std::size_t N>
	void value( T ( &array )[N] )
	{
		if constexpr ( IsFlat<T>::value )
		{
			raw( array, sizeof( array ) );
		}
		else
		{
			for ( T& each : array )
			{
				value( each );
			}
		}
	}

	std::vector<std::byte>* m_to = nullptr;
	std::byte *m_at = nullptr, *m_limit = nullptr; ///< where it writes, and the end of the list
	const std::byte *m_from = nullptr, *m_end = nullptr;
	const char* m_problem = nullptr;
	bool m_isTrusted = false;
};

/// A hash of bytes, which changes with any change of one of them. Another seed gives another hash.
std::uint64_t hashOf( const std::byte* data, std::size_t size, std::uint64_t seed = 0 );

} // namespace pliant
